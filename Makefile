# Everything runs in .venv, which the first command makes; nothing else has to be installed.
PYTHON ?= python3
BIN := .venv/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
export OMP_NUM_THREADS ?= 1
# Tests start hundreds of processes; without compiled files each of them compiles srgc anew.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo quick test timings test-slow campaigns coverage docs editor playground pictures gallery golden grammar fmt lint types
.PHONY: dist sbom hooks bench srgc-bench paper lock clean

KERNEL := compiler/expressions/machine/ball_kernel.c

.venv/installed: requirements/dev.lock pyproject.toml $(KERNEL)
	@echo "installing into .venv (a few minutes, 1.8 GB)"
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r requirements/dev.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

demo: .venv/installed
	$(BIN)/srgc synth specs/planar_arm.srg -o out/demo
	$(BIN)/srgc verify out/demo
	@echo "pictures: out/demo/figures/workspace.svg and out/demo/figures/inputs.svg"

# The tests that take less than 0.015 s each, start no process and share nothing slow. Two processes
# with half of the files each take two thirds of the time of two workers that import all files and
# report every test.
QUICK := -m "not slow and not site and not types and not editor and not playground and not long"

quick: .venv/installed
	@mkdir -p out
	@$(BIN)/pytest $(QUICK) --files 2/2 > out/quick.log 2>&1 & other=$$!; \
	$(BIN)/pytest $(QUICK) --files 1/2; one=$$?; \
	wait $$other; two=$$?; cat out/quick.log; exit $$((one | two))

# Each of two workers begins with half of the tests, file by file, and takes of the other's at the
# end: what the tests of a file share is hardly ever made twice.
WORKERS := -n 2 --dist worksteal

test: .venv/installed
	$(BIN)/pytest $(WORKERS)

# Records which tests `make quick` and `make test` leave out; best on a machine that does nothing else.
timings: .venv/installed
	$(BIN)/pytest $(WORKERS) --record-long

# The usual suite, with the branches taken in this process, its workers and those they start.
coverage: .venv/installed
	$(BIN)/pytest $(WORKERS) --cov --cov-report=term:skip-covered --cov-report=json:out/coverage.json

# Pinocchio, an independent library of rigid-body dynamics, is installed for the slow tests alone.
.venv/oracles: .venv/installed requirements/slow.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r requirements/slow.lock
	touch $@

# All tests but the campaigns, with other random examples each time. Run again after an interruption
# or a failure, it leaves out what has passed with the same code; `make test-slow SHARD=2/6` is a sixth.
SLOWLY := --hypothesis-profile=others --ledger=out/slow $(if $(SHARD),--shard=$(SHARD))

test-slow: .venv/oracles .venv/timor/installed
	$(BIN)/pytest $(WORKERS) -m "not campaign" $(SLOWLY)

# Further cases of long random tests, three times as many: after a change of what they try.
campaigns: .venv/oracles
	$(BIN)/pytest $(WORKERS) -m campaign $(SLOWLY)

# The pages as a site, with the notebooks run; a warning is an error. Then the tests of the site.
docs: .venv/installed
	$(BIN)/sphinx-build -W --keep-going -n -q -b html docs out/docs/html
	SRGC_DOCS_BUILT=out/docs/html $(BIN)/pytest -n 2 -m 'site and not slow'
	@echo "pages: out/docs/html/index.html"

# The pictures of the pages, drawn again by srgc, and the printed cheat sheet; the suite compares them
# with what it draws.
pictures: .venv/installed
	mkdir -p out
	sed -n '/^```srg fetch.srg/,/^```$$/{/^```/!p}' README.md > out/fetch.srg
	$(BIN)/srgc synth out/fetch.srg --force -o out/fetch
	$(BIN)/srgc export out/fetch --to svg -o docs/pictures/fetch.svg
	$(BIN)/python docs/_extensions/cheat_sheet.py

# Runs the examples of docs/gallery, measures them and writes the page, best on a machine that does
# nothing else. Run again, it leaves out what is finished; `make gallery SHARD=1/4` is a quarter.
gallery: .venv/installed
	$(BIN)/python benchmarks/gallery.py $(if $(SHARD),--shard=$(SHARD))

# The extension for VS Code, as out/srg-VERSION.vsix, and its tests; needs Node 20 and npm.
editors/vscode/node_modules/.package-lock.json: editors/vscode/package-lock.json
	cd editors/vscode && npm ci
	touch $@

editor: .venv/installed editors/vscode/node_modules/.package-lock.json
	mkdir -p out
	rm -f out/srg-*.vsix
	cd editors/vscode && npm run --silent package -- -o ../../out/
	SRGC_VSIX=$$(echo out/srg-*.vsix) $(BIN)/pytest -m editor tests/editors

# The page that checks specs in a browser, as out/playground, and its tests; needs Node 20 and npm.
editors/playground/node_modules/.package-lock.json: editors/playground/package-lock.json
	cd editors/playground && npm ci
	touch $@

playground: .venv/installed editors/playground/node_modules/.package-lock.json
	rm -rf out/wheels
	$(BIN)/python editors/playground/wheels.py out/wheels
	cd editors/playground && npm run --silent build -- ../../out/wheels ../../out/playground
	SRGC_PLAYGROUND_BUILT=out/playground $(BIN)/pytest -m playground tests/playground
	@echo "page: out/playground/index.html, to be served"

# Rewrites what the pages of codes and of tests/golden show; read the difference before you keep it.
golden: .venv/installed
	-UPDATE_GOLDEN=1 $(BIN)/pytest tests/test_golden.py tests/test_language_reference.py
	$(BIN)/pytest tests/test_golden.py tests/test_language_reference.py

# The parser's tables, after a change of grammar_lang/parsing/srg.lark.
grammar: .venv/installed
	$(BIN)/python -m grammar_lang.parsing.table_generator

fmt: .venv/installed
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

lint: .venv/installed
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/lint-imports --no-cache
	$(BIN)/check-jsonschema --builtin-schema vendor.github-workflows .github/workflows/*.yml
	$(BIN)/check-jsonschema --builtin-schema vendor.citation-file-format --default-filetype yaml CITATION.cff
	$(BIN)/pre-commit validate-config

types: .venv/installed
	$(BIN)/mypy
	$(BIN)/pytest -n 0 -m types tests/test_structure.py

# The wheel and the source distribution, and the wheel tried in an environment without anything else.
dist: .venv/installed
	rm -rf out/dist
	$(BIN)/python -m build --no-isolation --outdir out/dist
	PYTHON=$(PYTHON) bash .ci/try_wheel out/dist/*.whl

# What the lock files bring, for those who have to keep account of it, as out/sbom/run.cdx.json (what
# srgc needs to run) and out/sbom/dev.cdx.json (with what its tests need).
sbom: .venv/installed
	PYTHON=$(BIN)/python bash .ci/sbom out/sbom

# Runs `make lint` and `make quick` at each commit and push.
hooks: .venv/installed
	$(BIN)/pre-commit install

# The libraries that users would pick instead are installed for the comparison alone.
.venv/compared: .venv/installed requirements/bench.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r requirements/bench.lock
	touch $@

# Timor, a toolbox for modular robots, wants other versions of what srgc is built on.
.venv/timor/installed: .venv/installed requirements/timor.lock
	$(PYTHON) -m venv --clear .venv/timor
	.venv/timor/bin/pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r requirements/timor.lock
	touch $@

bench: .venv/compared .venv/timor/installed
	$(BIN)/python benchmarks/record.py -o out/bench

# What srgc makes of the tasks in benchmarks/tasks; docs/reference/benchmark-set.md has more.
srgc-bench: .venv/installed
	$(BIN)/python benchmarks/srgc_bench.py

# The paper's figures, algorithm, case study and claims beside what srgc computes, on one page. What is
# computed is kept in out/paper, and an interrupted run goes on where it ended; for a quick look,
# `make paper PAPER_SEEDS=3 PAPER_OPTIONS="--evaluations 10 --points 5"`.
PAPER_SEEDS ?= 20

paper: .venv/installed
	$(BIN)/python benchmarks/paper_page.py --seeds $(PAPER_SEEDS) $(PAPER_OPTIONS)

# Needs uv and the network; every other target uses what it wrote.
COMPILE := uv pip compile --quiet --universal --python-version 3.11 --generate-hashes \
  --no-emit-index-url --no-emit-find-links

# Its Pinocchio was built against these; their own bounds on each other are too wide.
TIMOR := timor-python==1.1.1 pygad==3.9.2 ompl==2.0.1 toppra==0.6.10 tqdm==4.67.1 \
  pin==2.7.0 hpp-fcl==2.4.4 eigenpy==3.5.1 cmeel-boost==1.83.0 numpy==1.26.4

lock:
	$(COMPILE) --extra test -o requirements/dev.lock pyproject.toml
	$(COMPILE) -c requirements/dev.lock -o requirements/run.lock pyproject.toml
	$(COMPILE) --extra bench -c requirements/dev.lock -o requirements/bench.lock pyproject.toml
	$(COMPILE) --extra oracles -c requirements/dev.lock -o requirements/slow.lock pyproject.toml
	printf '%s\n' $(TIMOR) | $(COMPILE) -o requirements/timor.lock -

clean:
	rm -rf .venv out build .coverage .mypy_cache .ruff_cache .pytest_cache .hypothesis *.egg-info editors/*/node_modules editors/vscode/dist
