/*
 * Taylor series of balls of doubles along a program, operation by operation.
 *
 * A ball is a pair (m, r) of doubles and stands for all reals within r of m. Operations are those
 * of IEEE 754, rounded to nearest: with u = 2^-53 a sum is off by at most u |m| from the exact one,
 * m being what is computed, a product, a quotient or a root by at most u |m| + 2^-1075. A sum of n
 * products that are added one by one is off by at most (n + 1) u times the sum of their sizes, but
 * for terms of second order in u, and n 2^-1075. Radii are sums of products of numbers that are not
 * negative, of fewer than 100 operations: what rounding takes from them, the factor GROW gives back,
 * and LEAST what is lost where numbers are too small to have all their bits.
 *
 * Where a thread rounds in another way (see fesetround), nothing has a value.
 *
 * No operation may be reassociated, and numbers have no more bits than doubles have; that one
 * operation is fused with another makes errors smaller only. An overflow makes a middle or a radius
 * infinite or no number, which whoever asks has to look for.
 *
 * Sources: van der Hoeven, Ball arithmetic (2010); Rump, Fast and parallel interval arithmetic
 * (1999); Higham, Accuracy and Stability of Numerical Algorithms (2002), section 3.1.
 */
#define PY_SSIZE_T_CLEAN
#define Py_LIMITED_API 0x030b0000
#include <Python.h>

#include <float.h>
#include <math.h>
#include <stdint.h>

#if defined(__FAST_MATH__)
#error "compile without -ffast-math"
#endif
#if FLT_EVAL_METHOD != 0
#error "operations are done in another precision; on x86, use -msse2 -mfpmath=sse"
#endif

/* An operation with two results has the second behind the first. */
enum { NEG, TWICE, ADD, SUB, MUL, DIV, SQRT, SIN_COS, FABS, SIGN, OPERATIONS };
/* What became of a program: an absolute value has its kink, or something has no value. */
enum { EXACT, UNCERTAIN, UNDEFINED };

static const double UNIT = 0x1p-53, GROW = 1 + 0x1p-45, LEAST = 0x1p-1000;
/* Rad; nothing is known of the sine of what is larger. */
static const double LARGEST_ANGLE = 1e5;
/* Of sine and cosine, see sine_and_cosine. */
static const double ANGLE_ERROR = 0x1p-49;

typedef struct {
    int32_t name, a, b, o;
} Step;

typedef struct {
    double *mid, *rad;    /* (values, length) */
    const uint8_t *fixed; /* (values,): constant, so that further coefficients are zero */
    Py_ssize_t length;
} Values;

typedef struct {
    double m, r;
} Ball;

static Ball get(const Values *v, int32_t row, int k)
{
    Py_ssize_t place = row * v->length + k;
    Ball found = {v->mid[place], v->rad[place]};
    return found;
}

static void put(const Values *v, int32_t row, int k, Ball ball)
{
    Py_ssize_t place = row * v->length + k;
    v->mid[place] = ball.m;
    v->rad[place] = ball.r;
}

/*
 * Sine and cosine of |x| <= 10^5, off by at most 2^-49 = 16 u.
 *
 * With k the integer next to x / (pi / 2) and r = x - k pi / 2, |r| < 0.7855: pi / 2 is the sum of
 * three parts, up to 2^-122; the first two have 33 bits, so that their products with k, which is
 * below 2^17, are exact. Each of three differences is off by u |r| and tiny terms, together by less
 * than 3 u. Taylor's polynomials are off by r^19 / 19! and r^20 / 20!, less than u / 100; Horner's
 * rule by less than 2 u, since the terms fall by more than a half each; the factorials' rounding by
 * less than u / 4, the last product by u. So 7 u is more than all of it.
 */
static void sine_and_cosine(double x, double *sine, double *cosine)
{
    double k = floor(x * 0.6366197723675814 + 0.5);
    double r = ((x - k * 0x1.921fb544p+0) - k * 0x1.0b4611a6p-34) - k * 0x1.3198a2e037073p-69;
    double z = r * r, s, c;

    s = 1.0 / 355687428096000.0;
    s = s * z - 1.0 / 1307674368000.0;
    s = s * z + 1.0 / 6227020800.0;
    s = s * z - 1.0 / 39916800.0;
    s = s * z + 1.0 / 362880.0;
    s = s * z - 1.0 / 5040.0;
    s = s * z + 1.0 / 120.0;
    s = s * z - 1.0 / 6.0;
    s = (s * z + 1.0) * r;
    c = -1.0 / 6402373705728000.0;
    c = c * z + 1.0 / 20922789888000.0;
    c = c * z - 1.0 / 87178291200.0;
    c = c * z + 1.0 / 479001600.0;
    c = c * z - 1.0 / 3628800.0;
    c = c * z + 1.0 / 40320.0;
    c = c * z - 1.0 / 720.0;
    c = c * z + 1.0 / 24.0;
    c = c * z - 1.0 / 2.0;
    c = c * z + 1.0;
    switch ((int)k & 3) {
    case 0: *sine = s; *cosine = c; break;
    case 1: *sine = c; *cosine = -s; break;
    case 2: *sine = -s; *cosine = -c; break;
    default: *sine = -c; *cosine = s; break;
    }
}

/* A ball over another: |a / b - m / d| = |(a - m) - (m / d) (b - d)| / |b|. */
static Ball quotient(Ball a, Ball b)
{
    double least = fabs(b.m) - b.r;
    Ball found = {NAN, INFINITY};

    if (least > LEAST) {
        found.m = a.m / b.m;
        found.r = ((a.r + fabs(found.m) * b.r) / least + UNIT * fabs(found.m) + LEAST) * GROW;
    }
    return found;
}

/* The sum of a_j b_{k - j} over first <= j <= last. */
static Ball shifted_sum(const Values *v, int32_t a, int32_t b, int k, int first, int last)
{
    const double *am = v->mid + a * v->length, *ar = v->rad + a * v->length;
    const double *bm = v->mid + b * v->length, *br = v->rad + b * v->length;
    double radius = 0, size = 0;
    Ball found = {0, 0};
    int j;

    for (j = first; j <= last; j++) {
        double x = am[j], y = bm[k - j], product = x * y;

        found.m += product;
        size += fabs(product);
        radius += (fabs(x) + ar[j]) * br[k - j] + ar[j] * fabs(y);
    }
    found.r = (radius + (last - first + 2) * UNIT * size + LEAST) * GROW;
    return found;
}

static Ball difference(Ball a, Ball b)
{
    Ball found = {a.m - b.m, 0};

    found.r = (a.r + b.r + UNIT * fabs(found.m)) * GROW;
    return found;
}

static Ball times(double factor, Ball a) /* a power of two, or minus one */
{
    Ball found = {factor * a.m, fabs(factor) * a.r};
    return found;
}

static void add(const Values *v, Step s, int k)
{
    Ball a = get(v, s.a, k), b = get(v, s.b, k);

    if (s.name == SUB) {
        b = times(-1, b);
    }
    if (k > 0 && v->fixed[s.a]) {
        put(v, s.o, k, b);
    } else if (k > 0 && v->fixed[s.b]) {
        put(v, s.o, k, a);
    } else {
        put(v, s.o, k, difference(a, times(-1, b)));
    }
}

static void multiply(const Values *v, Step s, int k)
{
    int32_t a = v->fixed[s.a] ? s.b : s.a, b = v->fixed[s.a] ? s.a : s.b;

    put(v, s.o, k, shifted_sum(v, a, b, k, v->fixed[b] ? k : 0, k));
}

/* y_k = (a_k - sum of b_j y_{k - j} over j >= 1) / b_0. */
static int divide(const Values *v, Step s, int k)
{
    Ball rest = get(v, s.a, k);

    if (k > 0 && !v->fixed[s.b]) {
        rest = difference(rest, shifted_sum(v, s.b, s.o, k, 1, k));
    }
    rest = quotient(rest, get(v, s.b, 0));
    put(v, s.o, k, rest);
    return rest.r < INFINITY ? EXACT : UNDEFINED;
}

/* y_k = (a_k - sum of y_j y_{k - j} over 0 < j < k) / (2 y_0). */
static int take_root(const Values *v, Step s, int k)
{
    Ball rest = get(v, s.a, k), root;

    if (k > 0) {
        rest = difference(rest, shifted_sum(v, s.o, s.o, k, 1, k - 1));
        rest = quotient(rest, times(2, get(v, s.o, 0)));
        put(v, s.o, k, rest);
        return rest.r < INFINITY ? EXACT : UNDEFINED;
    }
    if (!(rest.m >= rest.r)) {
        return UNDEFINED;
    }
    root.m = sqrt(rest.m);
    /* |sqrt(a) - sqrt(m)| <= |a - m| / sqrt(m); a point may be zero. */
    root.r = rest.m > 0 ? (rest.r / root.m + UNIT * root.m + LEAST) * GROW : 0;
    put(v, s.o, 0, root);
    return EXACT;
}

/* How far off sine or cosine are: |slope| r + r^2 / 2, and as far as the angle is. */
static double sine_radius(double slope, double r)
{
    double curved = (fabs(slope) + ANGLE_ERROR) * r + r * r / 2;

    return ((curved < r ? curved : r) + ANGLE_ERROR) * GROW;
}

/* The sum of j a_j y_{k - j} over j >= 1, by k. */
static Ball next_sine(const Values *v, int32_t a, int32_t other, int k)
{
    double radius = 0, size = 0;
    Ball found = {0, 0};
    int j;

    for (j = 1; j <= k; j++) {
        Ball x = get(v, a, j), y = get(v, other, k - j);
        double product = (j * x.m) * y.m;

        found.m += product;
        size += fabs(product);
        radius += j * ((fabs(x.m) + x.r) * y.r + x.r * fabs(y.m));
    }
    found.m /= k;
    found.r = ((radius + (k + 3) * UNIT * size + LEAST) / k + UNIT * fabs(found.m)) * GROW;
    return found;
}

/* k s_k = sum of j a_j c_{k - j}, k c_k = - sum of j a_j s_{k - j}, over j >= 1. */
static void turn(const Values *v, Step s, int k)
{
    Ball sine = {0, 2}, cosine = {0, 2}, angle = get(v, s.a, 0);

    if (k > 0) {
        sine = next_sine(v, s.a, s.o + 1, k);
        cosine = times(-1, next_sine(v, s.a, s.o, k));
    } else if (fabs(angle.m) <= LARGEST_ANGLE && angle.r < 2) {
        sine_and_cosine(angle.m, &sine.m, &cosine.m);
        sine.r = sine_radius(cosine.m, angle.r);
        cosine.r = sine_radius(sine.m, angle.r);
    }
    put(v, s.o, k, sine);
    put(v, s.o + 1, k, cosine);
}

/*
 * Absolute value and its slope; where the sign is uncertain, up to the order that both have.
 *
 * Of a Lipschitz function the Taylor polynomial of degree one with its integral remainder holds
 * with any slope between (Clarke's gradient).
 */
static int take_size(const Values *v, Step s, int k, int smooth)
{
    Ball first = get(v, s.a, 0), a = get(v, s.a, k), found = {0, 0};
    double sign = first.m > first.r ? 1 : -first.m > first.r ? -1 : 0;
    double size = (fabs(a.m) + a.r) * GROW;

    if (sign == 0 && (smooth || k >= (s.name == SIGN ? 1 : 2))) {
        return UNCERTAIN;
    }
    if (s.name == SIGN && k == 0) {
        found.m = sign;
        found.r = sign == 0 ? 1 : 0;
    } else if (s.name == FABS && sign != 0) {
        found = times(sign, a);
    } else if (s.name == FABS) {
        found.m = k == 0 ? size / 2 : 0;
        found.r = k == 0 ? size / 2 * GROW : size;
    }
    put(v, s.o, k, found);
    return EXACT;
}

static int carry_out(const Values *v, Step s, int k, int smooth)
{
    switch (s.name) {
    case NEG: put(v, s.o, k, times(-1, get(v, s.a, k))); return EXACT;
    case TWICE: put(v, s.o, k, times(2, get(v, s.a, k))); return EXACT;
    case ADD: case SUB: add(v, s, k); return EXACT;
    case MUL: multiply(v, s, k); return EXACT;
    case DIV: return divide(v, s, k);
    case SQRT: return take_root(v, s, k);
    case SIN_COS: turn(v, s, k); return EXACT;
    default: return take_size(v, s, k, smooth);
    }
}

/* Whether this thread rounds to nearest, and does not take tiny numbers for zero. */
static int rounds_to_nearest(void)
{
    volatile double one = 1, half = 0x1p-53, more = 0x1.8p-53, tiny = 0x1p-1060;

    return one + half == one && one + more > one && -one - more < -one && tiny * half == 0 &&
           tiny / 2 > 0 && tiny / 2 + tiny / 2 == tiny;
}

static int coefficients(const Values *v, const Step *code, Py_ssize_t count, int first, int last,
                        int smooth)
{
    Py_ssize_t i;
    int k;

    if (!rounds_to_nearest()) {
        return UNDEFINED;
    }
    for (i = 0; i < count; i++) {
        int end = v->fixed[code[i].o] && last > 1 ? 1 : last;

        for (k = first; k < end; k++) {
            int found = carry_out(v, code[i], k, smooth);

            if (found != EXACT) {
                return found;
            }
        }
    }
    return EXACT;
}

/* --- What Python sees ------------------------------------------------------------------------- */

static const char COEFFICIENTS[] =
    "coefficients(code, mid, rad, fixed, first, last, smooth)\n--\n\n"
    "Compute the coefficients ``first`` ... ``last`` - 1 of all values of a program in place.\n\n"
    "Those before, and all of the inputs, are there.  ``code`` (steps, 4) has an operation per\n"
    "row, the places of two arguments and of the result; ``mid`` and ``rad`` (values, length) are\n"
    "the coefficients, those of ``fixed`` (values,) ones beyond the first being 0.  With\n"
    "``smooth`` each absolute value has to be.  Returns what became of it; the values are of no\n"
    "use unless it is ``EXACT``.";

static int fits(const Step *code, Py_ssize_t count, Py_ssize_t values)
{
    Py_ssize_t i;

    for (i = 0; i < count; i++) {
        Step s = code[i];
        int32_t last = s.name == SIN_COS ? s.o + 1 : s.o;

        if (s.name < 0 || s.name >= OPERATIONS || s.a < 0 || s.a >= s.o || s.b < 0 ||
            s.b >= s.o || last >= values) {
            return 0;
        }
    }
    return 1;
}

static PyObject *py_coefficients(PyObject *self, PyObject *args)
{
    Py_buffer code, mid, rad, fixed;
    int first, last, smooth, found = -1;
    PyObject *result = NULL;

    (void)self;
    if (!PyArg_ParseTuple(args, "y*w*w*y*iii", &code, &mid, &rad, &fixed, &first, &last,
                          &smooth)) {
        return NULL;
    }
    {
        Py_ssize_t steps = code.len / (Py_ssize_t)sizeof(Step), values = fixed.len;
        Py_ssize_t length = values > 0 ? mid.len / (Py_ssize_t)sizeof(double) / values : 0;
        Values v = {mid.buf, rad.buf, fixed.buf, length};

        if (mid.len == rad.len && mid.len == values * length * (Py_ssize_t)sizeof(double) &&
            first >= 0 && last <= length && fits(code.buf, steps, values)) {
            Py_BEGIN_ALLOW_THREADS
            found = coefficients(&v, code.buf, steps, first, last, smooth);
            Py_END_ALLOW_THREADS
            result = PyLong_FromLong(found);
        } else {
            PyErr_SetString(PyExc_ValueError, "the arrays of a program do not fit together");
        }
    }
    PyBuffer_Release(&code);
    PyBuffer_Release(&mid);
    PyBuffer_Release(&rad);
    PyBuffer_Release(&fixed);
    return result;
}

static PyMethodDef METHODS[] = {
    {"coefficients", py_coefficients, METH_VARARGS, COEFFICIENTS},
    {NULL, NULL, 0, NULL},
};

static struct PyModuleDef MODULE = {
    PyModuleDef_HEAD_INIT, "ball_kernel", "Taylor series of balls of doubles, in machine code.",
    -1, METHODS, NULL, NULL, NULL, NULL,
};

PyMODINIT_FUNC PyInit_ball_kernel(void);

PyMODINIT_FUNC PyInit_ball_kernel(void)
{
    return PyModule_Create(&MODULE);
}
