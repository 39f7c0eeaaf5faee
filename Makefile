# `make demo` shows what the program does, `make test` checks it. Both set up .venv first, once per pyproject.toml.

PYTHON ?= python3
BIN := .venv/bin
STAMP := .venv/.installed
JOBS ?= 2

.PHONY: demo docs test test-full test-hours test-format coverage lint types pytest bench peers fuzz corpus vsix clean help

help:
	@echo "make demo   install into .venv, convert a real humanoid, show the result"
	@echo "make test   ruff, mypy --strict, pytest"
	@echo "make test-full  the same with the tests that take minutes, one to two hours in all: large sizes, more robots"
	@echo "make test-hours  what these leave out: every robot in every format, twenty edits of each"
	@echo "make test-format FORMAT=urdf  what belongs to one format, without real robots"
	@echo "make coverage  which lines no test runs; writes docs/coverage.md"
	@echo "make bench  speed as ratios against yardsticks timed in the same run, other people's programs among them; writes docs/speed.md"
	@echo "make docs   the pages as a site with search in build/site; a warning is an error"
	@echo "make peers  other people's programs, each into .peers/, and the tests that compare with them"
	@echo "make fuzz   damage texts of every format and read them; PROFILE=ci (minutes) or nightly (hours)"
	@echo "make corpus every robot of the catalogue through every format, verified; renews corpus/results and its pages"
	@echo "make vsix   the extension for VS Code, by npm: editors/vscode/hymeko-x.vsix"
	@echo "make clean  remove .venv and everything that was built"

$(STAMP): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "hymeko-x needs Python 3.11 or newer, and $(PYTHON) is " + sys.version.split()[0] + "; try: make PYTHON=python3.12")'
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@echo "installing hymeko-x into .venv (once; takes a few minutes)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[test]'
	@touch $@

demo: $(STAMP)
	@PATH="$(CURDIR)/$(BIN):$$PATH" sh examples/demo.sh

test: lint types pytest

lint: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(STAMP)
	$(BIN)/mypy

pytest: $(STAMP)
	$(BIN)/python -m pytest -W error -n $(JOBS) -m "not full" tests

test-full: lint types
	$(BIN)/python -m pytest -W error -n $(JOBS) -m "not hours" tests

test-hours: $(STAMP)
	$(BIN)/python -m pytest -W error -n $(JOBS) -m hours tests

FORMAT ?= urdf

test-format: $(STAMP)
	$(BIN)/python -m pytest -q -W error -n $(JOBS) -m "not full and not corpus and not slow and not peers" $(if $(filter hymeko,$(FORMAT)),tests/language,tests/$(FORMAT))

coverage: $(STAMP)
	$(BIN)/python -m pytest -W error -n $(JOBS) -m "not full" --cov --cov-report=json:.coverage.json tests
	$(BIN)/python -m tests.coverage_page .coverage.json docs/coverage.md

bench: $(STAMP)
	@$(BIN)/python -m peers || echo "what could not be installed has no figures"
	@for name in parse load load_mjcf growth size residue speed sdf whole usd meshes contest; do $(BIN)/python -m benchmarks.$$name || failed=1; done; exit $${failed:-0}

docs: $(STAMP)
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet
	@echo "build/site is there; $(BIN)/python -m http.server -d build/site shows it at http://localhost:8000"

peers: $(STAMP)
	$(BIN)/python -m peers
	$(BIN)/python -m pytest -W error -m peers tests

PROFILE ?= ci
GUIDED_SECONDS := $(if $(filter nightly,$(PROFILE)),3600,30)

fuzz: $(STAMP)
	HYPOTHESIS_PROFILE=$(PROFILE) $(BIN)/python -m pytest -q -n $(JOBS) tests/test_pipeline_laws.py tests/test_format_laws.py tests/verify/test_verify_laws.py tests/urdf/test_laws.py tests/language/test_laws.py tests/language/test_grammar_texts.py
	$(BIN)/python -m tests.fuzz --profile $(PROFILE)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --only-binary :all: atheris || echo "atheris has no wheel for this Python; the guided part is left out"
	@for format in hymeko urdf mjcf usd sdf; do $(BIN)/python -m tests.fuzz.guided $$format -max_total_time=$(GUIDED_SECONDS) -verbosity=0 || failed=1; done; exit $${failed:-0}

corpus: $(STAMP)
	$(BIN)/hymeko-x corpus fetch
	$(BIN)/hymeko-x corpus run --verify --resume --jobs $(JOBS) -o corpus-run
	$(BIN)/hymeko-x corpus stats corpus-run -o corpus/results --page README.md --page docs/results.md --page docs/losses.md --page docs/scale.md

vsix:
	@command -v npm >/dev/null || { echo "npm is not on the path; it comes with Node.js 20 or newer"; exit 1; }
	cp LICENSE editors/vscode/
	cd editors/vscode && npm install --no-audit --no-fund --no-package-lock --ignore-scripts && npm run package

clean:
	rm -rf .venv .peers build dist demo editors/vscode/node_modules editors/vscode/dist editors/vscode/*.vsix .mypy_cache .pytest_cache .ruff_cache
