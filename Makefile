# Screed: every entry point. `make help` prints them from the rules: a target with a comment behind two hashes is one.
#
# The first make installs missing packages (DEPS=no switches that off) and calls a second one, which does the work: its
# rules may use what has just been installed. Everything is built under build/, results go to out/.

SHELL := /bin/bash
.SHELLFLAGS := -o pipefail -ec
.DELETE_ON_ERROR:
.SUFFIXES:
MAKEFLAGS += --no-builtin-rules
.DEFAULT_GOAL := help

DEPS ?= yes
# Lists of Debian packages: what everything needs, and what single targets need beside it.
PACKAGE_LISTS := tools/debian-packages.txt $(if $(filter fuzz test-asan,$(MAKECMDGOALS))$(filter asan,$(BUILD)),tests/fuzz/debian-packages.txt) \
                 $(if $(filter arm64,$(BUILD))$(filter test-portable test-processors,$(MAKECMDGOALS)),tools/arm64/debian-packages.txt) \
                 $(if $(filter test-can,$(MAKECMDGOALS)),tests/can/debian-packages.txt) \
                 $(if $(filter test-slurm,$(MAKECMDGOALS)),tests/slurm/debian-packages.txt) \
                 $(if $(filter test-python,$(MAKECMDGOALS)),tests/python/debian-packages.txt) \
                 $(if $(filter test-report,$(MAKECMDGOALS)),tests/report/debian-packages.txt) \
                 $(if $(filter camera test-camera,$(MAKECMDGOALS)),tools/camera/debian-packages.txt) \
                 $(if $(shell command -v npm),,$(if $(filter build report-page install test-install test-report,$(MAKECMDGOALS)),tools/report/debian-packages.txt))
BUILD_FILES := Makefile $(sort $(wildcard tools/build/*.mk hal/avr/*.mk nn/*/*.mk tests/*.mk tests/*/*.mk tools/*/*.mk tools/*/*/*.mk))

.PHONY: help deps clean
help:  ## print this list
	@awk -f tools/build/help.awk $(BUILD_FILES)
deps:  ## install missing Debian packages (DEPS=no: never)
	@tools/install-deps.sh $(DEPS) $(PACKAGE_LISTS)
clean:  ## remove build/ (results in out/ stay)
	rm -rf build

ifndef INSTALLED
# ---- the first make --------------------------------------------------------------------------------------------------
# `lint` goes on after a finding, to show all of them.
WORK := $(filter-out help deps clean,$(MAKECMDGOALS))
.PHONY: work $(WORK)
$(WORK): work
	@:
work: deps
	+@$(MAKE) --no-print-directory $(if $(filter 0,$(MAKELEVEL)),$(if $(findstring -j,$(MAKEFLAGS)),,-j$(shell nproc))) $(if $(filter lint,$(WORK)),-k) INSTALLED=yes $(WORK)
else
# ---- the second make: the rules of each part -------------------------------------------------------------------------
include tools/build/options.mk
include tools/schema/schema.mk
include tools/build/host.mk
include hal/avr/firmware.mk
include tools/arduino/arduino.mk
include tools/report/report.mk
include tests/tests.mk
include tools/flash/flash.mk
include tools/bench/bench.mk
include tools/bench/telemetry/telemetry_lab.mk
include tests/fuzz/fuzz.mk
include tests/can/can.mk
include tests/slurm/slurm.mk
include tests/python/python.mk
include tests/portable/portable.mk
include tools/camera/camera.mk
include tests/processors/processors.mk
include tests/report/report_tests.mk
include tests/asan.mk
include tools/mutants/mutants.mk
include nn/training/training.mk
include tools/lint/lint.mk
-include $(shell find $(BUILD_ROOT) -name sysroot -prune -o -name '*.d' -print 2> /dev/null)
endif
