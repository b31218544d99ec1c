# Unit tests, software-in-the-loop tests, tests of the microcontroller's images, and the long ones of all these. Included by the top
# Makefile after the parts whose tests it runs; parts with tests of their own (tools/flash) add to TESTS and TEST_IMAGES.
#
# tests/unit mirrors the folders of the sources. A test of more than two seconds lies in tests/long, whose program `make test` neither
# compiles nor links.

UNIT_SOURCES := $(call sources,tests/unit)
SITL_SOURCES := $(call sources,tests/sitl)
LONG_SOURCES := $(filter-out tests/long/mcu/%,$(call sources,tests/long))
SCHEMA_LIBRARY_SOURCES := $(filter-out tools/schema/main.cpp,$(call sources,tools/schema))
LAB_LIBRARY_SOURCES := $(filter-out tools/bench/telemetry/main.cpp,$(call sources,tools/bench/telemetry))
TESTS := $(B)/tests/unit_tests $(B)/tests/sitl_tests
LONG_TESTS := $(B)/tests/long_tests
ifeq ($(MCU),yes)
include tests/mcu/mcu_tests.mk
endif

$(eval $(call with_headers,test,$(UNIT_SOURCES) $(SITL_SOURCES) $(LONG_SOURCES) $(MCU_TEST_SOURCES) $(MCU_LONG_SOURCES)))

TEST_LIBRARIES = $$(pkg-config --libs $(TEST_PACKAGES))
UNIT_TESTS_PARTS := $(call objects,$(UNIT_SOURCES) $(SCHEMA_LIBRARY_SOURCES) $(LAB_LIBRARY_SOURCES)) $(LIBRARY) $(B)/libavr_tools.a $(B)/libmutants.a
$(B)/tests/unit_tests: $(UNIT_TESTS_PARTS) $(B)/link.flags
	$(call link,$(TEST_LIBRARIES))
$(B)/tests/sitl_tests: $(call objects,$(SITL_SOURCES)) $(LIBRARY) $(B)/link.flags
	$(call link,$(TEST_LIBRARIES))
$(LONG_TESTS): $(call objects,$(LONG_SOURCES)) $(MCU_LONG_PARTS) $(filter-out $(call objects,$(UNIT_SOURCES)),$(UNIT_TESTS_PARTS)) $(B)/link.flags
	$(call link,$(TEST_LIBRARIES))

# Every host source that is compiled with the host's flags or the firmware's: what lint and clangd look at.
ALL_HOST_SOURCES = $(LIBRARY_SOURCES) tools/screed/main.cpp $(call sources,tools/avr tools/schema tools/bench tools/flash tools/mutants tests/unit tests/sitl tests/flash) $(LONG_SOURCES)

# Expanded twice: later parts add their tests.
.SECONDEXPANSION:
.PHONY: test test-long
test: $(SCREED) $$(TESTS) $$(TEST_IMAGES)  ## build and run the tests that take seconds (BUILD=asan: under the sanitizers)
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/run.sh $(TESTS)
test-long: $(SCREED) $(LONG_TESTS) $$(TEST_IMAGES)  ## build and run those that take longer: long drives, whole runs, minutes of the microcontroller
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/run.sh $(LONG_TESTS)

# The tests of single sources: quick to build, for whoever works on them. Which ones, no date of a file says: linked each time.
.PHONY: test-file test-tutorial
test-file: $(SCREED) $(B)/tests/test_file  ## build and run single tests (TEST='tests/unit/firmware/leveling/*_test.cpp')
	@SCREED_PROGRAM=$(abspath $(SCREED)) $(B)/tests/test_file $(ARGS)
$(B)/tests/test_file: $(call objects,$(wildcard $(TEST))) $(filter-out $(call objects,$(UNIT_SOURCES)),$(UNIT_TESTS_PARTS)) $(B)/link.flags FORCE
	$(if $(wildcard $(TEST)),,$(error TEST='FILE...' names sources of tests; there is none of the name '$(TEST)'))
	$(call link,$(TEST_LIBRARIES))
test-tutorial: $(SCREED)  ## the commands of docs/tutorial.md, from top to bottom, in a copy of the tree
	@tests/docs/tutorial.sh docs/tutorial.md

.PHONY: test-install
test-install: $(SCREED) $(B)/screed_flash $(REPORT_PAGE)  ## install, move the tree, run it from elsewhere
	@tests/install/run.sh
