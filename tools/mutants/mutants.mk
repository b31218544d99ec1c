# Mutation testing: which small changes of the sources the tests notice. Included by the top Makefile.
#
# Results are kept in build/mutants: a second run does only what sources or tests made necessary.
# Needs host.mk and tests/tests.mk.

MUTANTS := $(B)/mutants
MUTANTS_WORK := $(BUILD_ROOT)/mutants

MUTANTS_LIBRARY_SOURCES := $(filter-out %/main.cpp %/mutant_switch.cpp %/reach_listener.cpp,$(call sources,tools/mutants))

$(B)/libmutants.a: $(call objects,$(MUTANTS_LIBRARY_SOURCES))
	@rm -f $@
	@ar rcs $@ $^
$(MUTANTS): $(B)/tools/mutants/main.o $(B)/libmutants.a
	@echo "  LINK $@"
	@$(CXX) $^ -pthread -o $@

# What the tool compiles and links mutants with.
.PHONY: mutants
mutants: $(MUTANTS) $(B)/tests/unit_tests $(B)/tests/sitl_tests $(SCREED) \
             $(B)/tools/mutants/mutant_switch.o $(B)/tools/mutants/reach_listener.o  ## which small changes of the sources the tests notice (ARGS='--file supervisor --sample 20 --list')
	@mkdir -p $(MUTANTS_WORK)
	@cp $(B)/tools/mutants/mutant_switch.o $(B)/tools/mutants/reach_listener.o $(MUTANTS_WORK)
	@echo $(CORE_SOURCES) > $(MUTANTS_WORK)/firmware.sources
	@echo $(UNIT_OBJECTS) $(TESTED) -Wl,--as-needed @$(B)/link.flags $$(pkg-config --libs $(TEST_PACKAGES)) > $(MUTANTS_WORK)/unit_tests.link
	@echo $(SITL_OBJECTS) $(LIBRARY) -Wl,--as-needed @$(B)/link.flags $$(pkg-config --libs $(TEST_PACKAGES)) > $(MUTANTS_WORK)/sitl_tests.link
	@echo $(B)/tools/screed/main.o $(LIBRARY) -Wl,--as-needed @$(B)/link.flags > $(MUTANTS_WORK)/screed.link
	@$(MUTANTS) --build $(B) --work $(MUTANTS_WORK) --jobs $(shell nproc) $(ARGS)
