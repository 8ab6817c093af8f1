# make setup     build .venv with tether, its tests' and its documentation's tools
# make demo      run examples/couette.toml and compare with theory (half a minute)
# make test      format and type checks, tests, documentation
# make benchmarks          speed, side by side with LAMMPS (half an hour)
# make instruction-sets    the tests under each instruction set that this processor has
# make sanitize-address    the tests of the engine under AddressSanitizer and UBSan; sanitize-thread: ThreadSanitizer
# make validate  long runs against literature and independent physics (an hour and a half; needs dieharder)
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DEFAULT_GOAL := setup
.DELETE_ON_ERROR:
.NOTPARALLEL:
.PHONY: setup demo test pytest lint format docs validate benchmarks instruction-sets sanitize-address sanitize-thread clean

PYTHON ?= python3
bin := .venv/bin
cpp_sources = $(shell find core bindings -name '*.hpp' -o -name '*.cpp' 2>/dev/null)
cpp_templates = $(wildcard core/kernels/*.cpp.in)

# An editable install: Python sources are read from src/, so only a change to the C++ sources, to the
# build files or to the dependencies builds anything again (incrementally, in build/).
setup: .venv/installed

.venv/dependencies: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "tether needs Python 3.11 or newer; name one: make setup PYTHON=python3.12")'
	test -x $(bin)/python || $(PYTHON) -m venv .venv
	$(bin)/python -m pip install --quiet --upgrade 'pip>=25.1'
	$(bin)/python -m pip install --quiet --group build --group test --group docs --group dev
	touch $@

.venv/installed: .venv/dependencies CMakeLists.txt pyproject.toml tools/python-headers $(cpp_sources) $(cpp_templates)
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

benchmarks: setup
	$(bin)/python -m pip install --quiet --group bench
	$(bin)/python -m benchmarks

instruction-sets: setup
	for set in $$($(bin)/python -c 'from tether.engines import instruction_sets as s; print(*[n for n, here in s().items() if here])'); do \
	    echo "--- $$set"; TETHER_INSTRUCTION_SET=$$set $(bin)/python -m pytest -q; done

# The module is built anew, beside the editable install, in an environment that finds everything else in .venv.
tests_of_engine = tests/engines tests/pairs tests/bodies tests/conservation tests/flows tests/laws/test_dpd.py tests/laws/test_steep.py \
    tests/observe/test_local_stress.py tests/observe/test_pair_histogram.py
sanitize-address: build/sanitize-address
	LD_PRELOAD="$$($(CXX) -print-file-name=libasan.so) $$($(CXX) -print-file-name=libstdc++.so)" ASAN_OPTIONS=detect_leaks=0 \
	    build/sanitize-address/bin/python -m pytest -q -s $(tests_of_engine)
sanitize-thread: build/sanitize-thread
	LD_PRELOAD=$$($(CXX) -print-file-name=libtsan.so) TSAN_OPTIONS=halt_on_error=1 \
	    build/sanitize-thread/bin/python -m pytest -q -s tests/engines/test_determinism.py

build/sanitize-%: setup
	$(PYTHON) -m venv --clear $@
	realpath .venv/lib/python*/site-packages > $$(echo $@/lib/python*/site-packages)/environment.pth
	source tools/python-headers && $@/bin/python -m pip install --quiet --no-build-isolation --no-deps . \
	    --config-settings=build-dir=$@/build --config-settings=cmake.define.TETHER_SANITIZE=$(if $(findstring address,$@),address$(comma)undefined,thread)
comma := ,

validate: setup
	$(bin)/python -m pytest validation

clean:
	rm -rf .venv build dist demo docs/_build docs/reference/generated src/tether/_core.pyi
	rm -rf .mypy_cache .pytest_cache .ruff_cache .hypothesis
