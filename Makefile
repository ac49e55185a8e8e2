# Everything runs in .venv, which the first command makes; nothing else has to be installed.
PYTHON ?= python3
BIN := .venv/bin
export OMP_NUM_THREADS ?= 1

.PHONY: demo test test-slow golden grammar fmt lint types bench lock clean

.venv/installed: requirements/dev.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/dev.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@

demo: .venv/installed
	$(BIN)/srgc synth specs/planar_arm.srg -o out/demo
	$(BIN)/srgc verify out/demo
	@echo "pictures: out/demo/figures/workspace.svg and out/demo/figures/inputs.svg"

test: .venv/installed
	$(BIN)/pytest -n 2 -m "not slow"

# Pinocchio, an independent library of rigid-body dynamics, is installed for the slow tests alone.
.venv/oracles: .venv/installed requirements/slow.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/slow.lock
	touch $@

test-slow: .venv/oracles
	$(BIN)/pytest -n 2

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
	$(BIN)/lint-imports

types: .venv/installed
	$(BIN)/mypy

# The libraries that users would pick instead are installed for the comparison alone.
.venv/compared: .venv/installed requirements/bench.lock
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/bench.lock
	touch $@

bench: .venv/compared
	$(BIN)/python benchmarks/front_end.py
	$(BIN)/python benchmarks/language.py
	$(BIN)/python benchmarks/dynamics.py
	$(BIN)/python benchmarks/planning.py
	$(BIN)/python benchmarks/partition.py
	$(BIN)/python benchmarks/search.py --seeds 5
	$(BIN)/python benchmarks/control.py -o out/control/growth.svg
	$(BIN)/python benchmarks/codesign.py
	$(BIN)/python benchmarks/verify.py
	$(BIN)/python benchmarks/run.py

# Needs pip-tools and the network; every other target uses what it wrote.
lock:
	pip-compile --extra test --generate-hashes --allow-unsafe --strip-extras \
	  --no-emit-index-url --no-emit-find-links -o requirements/dev.lock pyproject.toml
	pip-compile --extra bench --generate-hashes --allow-unsafe --strip-extras \
	  --no-emit-index-url --no-emit-find-links -c requirements/dev.lock \
	  -o requirements/bench.lock pyproject.toml
	pip-compile --extra oracles --generate-hashes --allow-unsafe --strip-extras \
	  --no-emit-index-url --no-emit-find-links -c requirements/dev.lock \
	  -o requirements/slow.lock pyproject.toml

clean:
	rm -rf .venv out .mypy_cache .ruff_cache .pytest_cache .hypothesis *.egg-info
