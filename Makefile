# Two commands do all the set-up: make demo, make test. Each makes its own environment in .venv.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin

# what is installed is compiled as it is first imported, which is a fraction of it; commands that tests
# start anew read compiled modules
unexport PYTHONDONTWRITEBYTECODE

.PHONY: demo test rules tests nightly campaigns lowest manual distributions benchmarks clean

demo: $(VENV)/.installed
	$(BIN)/chatter examples flexible-workpiece --run --open --out demo-output

# the rules beside the tests: they take one processor alone
test: $(VENV)/.installed-dev
	$(MAKE) --no-print-directory --jobs 2 rules tests

rules: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/mypy

tests: $(VENV)/.installed-dev
	$(BIN)/pytest -n auto --dist loadfile --no-loadscope-reorder

# every test, the nightly ones among them; what was found goes into docs/validation.md
nightly: $(VENV)/.installed-dev
	mkdir -p build/nightly
	$(BIN)/pytest -n auto --dist loadfile --no-loadscope-reorder -m 'not browser and not ansys' --junitxml build/nightly/tests.xml; \
		found=$$?; $(BIN)/python -m tests.nightly_record build/nightly/tests.xml && exit $$found

# what takes hours: properties and damaged files in numbers, commands killed at random moments
campaigns: $(VENV)/.installed-dev
	CHATTER_PROPERTIES=2500 CHATTER_FUZZING=500 $(BIN)/pytest tests/validation/test_properties.py tests/benchmarks/test_fuzzing.py
	$(BIN)/python -m benchmarks.fuzzing build/campaigns/fuzzing --count 100000 --seed $$(date +%Y%m%d)
	$(BIN)/python -m benchmarks.killed_commands build/campaigns/killed --kills 30

# tests with the oldest libraries of pyproject.toml, which warn of each other, by the oldest Python: make lowest OLDEST=python3.10
OLDEST ?= $(PYTHON)
LOWEST := .venv-lowest/bin
lowest: .venv-lowest/.installed
	$(LOWEST)/pytest -W ignore::DeprecationWarning tests/chatter/description tests/chatter/io tests/chatter/cli tests/dynamics tests/cutting tests/validation tests/stored_numbers

.venv-lowest/.installed: $(VENV)/.installed-dev pyproject.toml
	$(OLDEST) -m venv .venv-lowest
	$(BIN)/python -m tests.lowest_versions > .venv-lowest/constraints.txt
	$(LOWEST)/python -m pip install --quiet --constraint .venv-lowest/constraints.txt --editable '.[formats]' 'pytest>=8' hypothesis jsonschema pyuff
	@touch $@

# the site in build/manual; no network is needed to build it
manual: $(VENV)/.installed-dev
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs build/manual
	@echo "build/manual/index.html"

# wheel and sdist in dist
distributions: $(VENV)/.installed-dev
	$(BIN)/python -m build

benchmarks: $(VENV)/.installed-dev
	$(BIN)/python -m benchmarks
	$(BIN)/python benchmarks/run.py

$(VENV)/.python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 10))' || \
		{ echo "Python 3.10 or later is needed; name one: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	@touch $@

$(VENV)/.installed: $(VENV)/.python pyproject.toml
	$(BIN)/python -m pip install --quiet --no-compile --editable .
	@touch $@

# everything in one step; what the demonstration needs is in it
$(VENV)/.installed-dev: $(VENV)/.python pyproject.toml
	$(BIN)/python -m pip install --quiet --no-compile --editable '.[dev,formats,manual]'
	@touch $(VENV)/.installed $@

clean:
	rm -rf $(VENV) .venv-lowest demo-output build dist docs/generated *.egg-info
