# Unit tests, software-in-the-loop tests, tests of the microcontroller's images, and the long ones of all these. Included by the top
# Makefile after the parts whose tests it runs; parts with tests of their own (tools/flash) add to TESTS and TEST_IMAGES.
#
# tests/unit mirrors the folders of the sources. A test of more than two seconds lies in tests/long, whose program `make test` neither
# compiles nor links.

UNIT_SOURCES := $(call sources,tests/unit)
SITL_SOURCES := $(call sources,tests/sitl)
LONG_SOURCES := $(filter-out tests/long/mcu/%,$(call sources,$(wildcard tests/long)))
SCHEMA_LIBRARY_SOURCES := $(filter-out tools/schema/main.cpp,$(call sources,tools/schema))
LAB_LIBRARY_SOURCES := $(filter-out tools/bench/telemetry/main.cpp,$(call sources,tools/bench/telemetry))
TESTS := $(B)/tests/unit_tests $(B)/tests/sitl_tests
LONG_TESTS := $(B)/tests/long_tests

# ---- groups: neighbouring tests are compiled as one source, since they share most of what they include ---------------------------------

# $(call in_groups,SET,SOURCES,FLAGS): SET_OBJECTS are the objects of all of them. What is no *_test.cpp, or needs flags of its own, stays
# alone.
TESTS_ALONE := tests/unit/tools/screed/viewer/gamepad_input_test.cpp
define in_groups
$(1)_ALONE := $(filter $(TESTS_ALONE),$(2)) $(filter-out %_test.cpp,$(2))
$(1)_GROUPS := $$(shell printf '%s\n' $$(filter-out $$($(1)_ALONE),$(2)) | awk -f tests/groups.awk)
$(1)_GROUP_OBJECTS := $$(foreach group,$$($(1)_GROUPS),$(B)/groups/$(1)/$$(firstword $$(subst :, ,$$(group))).o)
$(1)_OBJECTS := $$($(1)_GROUP_OBJECTS) $$(call objects,$$($(1)_ALONE))
$$($(1)_GROUP_OBJECTS): GROUP_FLAGS = $(3)
$$($(1)_GROUP_OBJECTS): HEADER_SET = test
$$($(1)_GROUP_OBJECTS): $(if $(filter yes,$(HEADERS)),$(B)/headers/test.h.gch)
$$(foreach group,$$($(1)_GROUPS),$$(eval $(B)/groups/$(1)/$$(subst :,.cpp: ,$$(subst $$(comma), ,$$(group)))))
endef
comma := ,
$(B)/groups/%.cpp: tests/paste.awk FORCE
	@mkdir -p $(@D)
	@awk -f tests/paste.awk $(filter tests/%_test.cpp,$^) | $(WRITE_CHANGED)
$(B)/groups/%.o: $(B)/groups/%.cpp $(B)/host.flags | $(GENERATED)
	@echo "  CXX  $*"
	@$(CXX) @$(B)/host.flags $(GROUP_FLAGS) $(HEADERS_FLAGS) $(SET_FLAGS) -MMD -MP -c $< -o $@

# ---- programs ----------------------------------------------------------------------------------------------------------------

$(eval $(call in_groups,UNIT,$(UNIT_SOURCES)))
$(eval $(call in_groups,SITL,$(SITL_SOURCES)))
$(eval $(call in_groups,LONG,$(LONG_SOURCES)))
ifeq ($(MCU),yes)
include tests/mcu/mcu_tests.mk
endif
# For `make test-file`, which compiles them one by one, and for those that stay alone.
$(eval $(call with_headers,test,$(UNIT_SOURCES) $(SITL_SOURCES) $(LONG_SOURCES) $(MCU_TEST_SOURCES) $(MCU_LONG_SOURCES)))

TEST_LIBRARIES = $$(pkg-config --libs $(TEST_PACKAGES))
# What tests are linked with.
TESTED := $(call objects,$(SCHEMA_LIBRARY_SOURCES) $(LAB_LIBRARY_SOURCES)) $(LIBRARY) $(B)/libavr_tools.a $(B)/libmutants.a
$(B)/tests/unit_tests: $(UNIT_OBJECTS) $(TESTED) $(B)/link.flags
	$(call link,$(TEST_LIBRARIES))
$(B)/tests/sitl_tests: $(SITL_OBJECTS) $(LIBRARY) $(B)/link.flags
	$(call link,$(TEST_LIBRARIES))
$(LONG_TESTS): $(LONG_OBJECTS) $(MCU_LONG_PARTS) $(TESTED) $(B)/link.flags
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
$(B)/tests/test_file: $(call objects,$(wildcard $(TEST))) $(TESTED) $(B)/link.flags FORCE
	$(if $(wildcard $(TEST)),,$(error TEST='FILE...' names sources of tests; there is none of the name '$(TEST)'))
	$(call link,$(TEST_LIBRARIES))
test-tutorial: $(SCREED)  ## the commands of docs/tutorial.md, from top to bottom, in a copy of the tree
	@tests/docs/tutorial.sh docs/tutorial.md

.PHONY: test-install
test-install: $(SCREED) $(B)/screed_flash $(REPORT_PAGE)  ## install, move the tree, run it from elsewhere
	@tests/install/run.sh
