# make setup     build .venv with tether, its tests' and its documentation's tools
# make demo      run examples/couette.toml and compare with theory (about a minute)
# make test      format and type checks, tests, documentation
# make validate  long runs against literature and independent physics (an hour and a half; needs dieharder)
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := setup
.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: setup demo test pytest lint format docs validate clean

PYTHON ?= python3
bin := .venv/bin
cpp_sources = $(shell find core bindings -name '*.hpp' -o -name '*.cpp' 2>/dev/null)

# An editable install: Python sources are read from src/, so only a change to the C++ sources, to the
# build files or to the dependencies builds anything again (incrementally, in build/).
setup: .venv/installed

.venv/dependencies: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "tether needs Python 3.11 or newer; name one: make setup PYTHON=python3.12")'
	test -x $(bin)/python || $(PYTHON) -m venv .venv
	$(bin)/python -m pip install --quiet --upgrade 'pip>=25.1'
	$(bin)/python -m pip install --quiet --group build --group test --group docs --group dev
	touch $@

.venv/installed: .venv/dependencies CMakeLists.txt pyproject.toml tools/python-headers $(cpp_sources)
	source tools/python-headers && $(bin)/python -m pip install --quiet --no-build-isolation --editable .
	touch $@

demo: setup
	$(bin)/tether run examples/couette.toml --relative --out demo --force

# pytest comes last, so that its closing lines close the log.
test: lint docs pytest

pytest: setup
	$(bin)/python -m pytest

lint: setup
	$(bin)/ruff format --check .
	$(bin)/ruff check .
	$(bin)/mypy
	$(bin)/clang-format --dry-run --Werror $(cpp_sources)

format: setup
	$(bin)/ruff format .
	$(bin)/ruff check --fix .
	$(bin)/clang-format -i $(cpp_sources)

docs: setup
	$(bin)/sphinx-build -W --keep-going --quiet -b html docs docs/_build/html

validate: setup
	$(bin)/python -m pytest validation

clean:
	rm -rf .venv build dist demo docs/_build docs/reference/generated src/tether/_core.pyi
	rm -rf .mypy_cache .pytest_cache .ruff_cache .hypothesis
