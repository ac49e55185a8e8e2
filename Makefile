# Everything runs in .venv, which the first command makes; nothing else has to be installed.
PYTHON ?= python3
BIN := .venv/bin
export OMP_NUM_THREADS ?= 1

.PHONY: demo test test-slow editor docs pictures golden grammar fmt lint types bench lock clean

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

# The pages as a site, with the notebooks run; a warning is an error.
docs: .venv/installed
	$(BIN)/sphinx-build -W --keep-going -n -q -b html docs out/docs/html
	@echo "pages: out/docs/html/index.html"

# The pictures of the pages, drawn again by srgc; the suite compares them with what it draws.
pictures: .venv/installed
	mkdir -p out
	sed -n '/^```srg fetch.srg/,/^```$$/{/^```/!p}' README.md > out/fetch.srg
	$(BIN)/srgc synth out/fetch.srg --force -o out/fetch
	cp out/fetch/figures/workspace.svg docs/pictures/fetch.svg

# The extension for VS Code, as out/srg-VERSION.vsix; needs Node 20 and npm.
editors/vscode/node_modules/.package-lock.json: editors/vscode/package-lock.json
	cd editors/vscode && npm ci
	touch $@

editor: editors/vscode/node_modules/.package-lock.json
	mkdir -p out
	cd editors/vscode && npm run --silent package -- -o ../../out/

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
	$(BIN)/python benchmarks/record.py -o out/bench

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
	rm -rf .venv out .mypy_cache .ruff_cache .pytest_cache .hypothesis *.egg-info editors/vscode/node_modules editors/vscode/dist
