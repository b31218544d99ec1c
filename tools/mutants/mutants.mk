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
$(MUTANTS): $(B)/tools/mutants/main.o $(B)/libmutants.a $(COMMAND_LINE)
	@echo "  LINK $@"
	@$(CXX) $^ -pthread -o $@
	$(call runnable,$@)

# What the tool compiles and links mutants with: for each program the arguments of the linker, and what its library is made of.
MUTANTS_LINK = -Wl,--as-needed @$(B)/link.flags
.PHONY: mutants
mutants: $(MUTANTS) $(B)/tests/unit_tests $(if $(findstring --unit,$(ARGS)),,$(B)/tests/sitl_tests $(SCREED)) \
             $(B)/tools/mutants/mutant_switch.o $(B)/tools/mutants/reach_listener.o  ## which small changes of the sources the tests notice (ARGS='--file supervisor --sample 20 --list')
	@mkdir -p $(MUTANTS_WORK)
	@rm -f $(MUTANTS_WORK)/*.link
	@cp $(B)/tools/mutants/mutant_switch.o $(B)/tools/mutants/reach_listener.o $(MUTANTS_WORK)
	@echo $(CORE_SOURCES) > $(MUTANTS_WORK)/firmware.sources
	@echo $(LIBRARY_OBJECTS) > $(MUTANTS_WORK)/library.objects
	@echo $(UNIT_OBJECTS) $(TESTED) $(MUTANTS_LINK) $(TEST_LIBRARIES) > $(MUTANTS_WORK)/unit_tests.link
	@echo $(SITL_OBJECTS) $(LIBRARY) $(MUTANTS_LINK) $(TEST_LIBRARIES) > $(MUTANTS_WORK)/sitl_tests.link
	@echo $(B)/tools/screed/main.o $(LIBRARY) $(MUTANTS_LINK) > $(MUTANTS_WORK)/screed.link
	@$(MUTANTS) --build $(B) --work $(MUTANTS_WORK) --jobs $(shell nproc) $(ARGS)
