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
# $(call packages_for,TARGETS,FOLDER): the list of that folder where one of the targets is asked for.
packages_for = $(if $(filter $(1),$(MAKECMDGOALS)),$(2)/debian-packages.txt)
PACKAGE_LISTS := tools/debian-packages.txt \
  $(or $(call packages_for,fuzz test-asan,tests/fuzz),$(if $(filter asan,$(BUILD)),tests/fuzz/debian-packages.txt)) \
  $(or $(call packages_for,test-portable test-processors,tools/arm64),$(if \
    $(filter arm64,$(BUILD)),tools/arm64/debian-packages.txt)) \
  $(call packages_for,test-can,tests/can) $(call packages_for,test-slurm,tests/slurm) \
  $(call packages_for,test-python test-tutorial test-processors,tests/python) \
  $(call packages_for,test-report,tests/report) \
  $(call packages_for,test-interface,tests/interface) $(call packages_for,packages test-packages,tools/package) \
  $(call packages_for,camera test-camera,tools/camera) $(call packages_for,pictures,tools/pictures) \
  $(if $(shell command -v npm)$(wildcard tools/report/built_page.html),,$(call \
    packages_for,build report-page install dist packages test-packages test-install test-report,tools/report))
BUILD_FILES := Makefile $(sort $(wildcard $(addsuffix /*.mk,\
  tools/build host_sim/* hal/avr nn/* tests tests/* tools/* tools/*/*)))

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
	+@$(MAKE) --no-print-directory $(if $(filter 0,$(MAKELEVEL)),$(if $(findstring -j,$(MAKEFLAGS)),,-j$(shell nproc))) \
	  $(if $(filter lint,$(WORK)),-k) INSTALLED=yes $(WORK)
else
# ---- the second make: the rules of each part -------------------------------------------------------------------------
include tools/build/options.mk
include tools/schema/schema.mk
include tools/build/host.mk
include host_sim/interface/interface.mk
include hal/avr/firmware.mk
include tools/arduino/arduino.mk
include tools/report/report.mk
include tests/tests.mk
include tools/flash/flash.mk
include tools/package/package.mk
include tools/bench/bench.mk
include tools/bench/telemetry/telemetry_lab.mk
include tests/fuzz/fuzz.mk
include tests/can/can.mk
include tests/slurm/slurm.mk
include tests/python/python.mk
include tests/limits/limits.mk
include tests/portable/portable.mk
include tools/camera/camera.mk
include tools/pictures/pictures.mk
include tests/processors/processors.mk
include tests/report/report_tests.mk
include tests/asan.mk
include tools/mutants/mutants.mk
include nn/training/training.mk
include tools/lint/lint.mk
# Not those of other trees below it.
-include $(shell find $(BUILD_ROOT) \( -name sysroot -o -name package \) -prune -o -name '*.d' -print 2> /dev/null)
endif
