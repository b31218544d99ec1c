# Mutation testing: which small changes of the sources the tests notice. Included by the top Makefile.
#
# Results are kept in build/mutants: a second run does only what sources or tests made necessary.
# Needs host.mk and tests/tests.mk.

MUTANTS_WORK := $(BUILD_ROOT)/mutants
# What mutants are linked with: for each program the arguments of the linker, and what its library is made of.
MUTANTS_LINK = -Wl,--as-needed @$(B)/link.flags
.PHONY: mutants test-mutants
mutants:  ## which small changes of the sources the tests notice (ARGS='--file supervisor --sample 20 --list')
mutants: $(B)/tests/unit_tests $(if $(findstring --unit,$(ARGS)),,$(B)/tests/sitl_tests $(SCREED))
	@mkdir -p $(MUTANTS_WORK)
	@rm -f $(MUTANTS_WORK)/*.link
	@echo $(LIBRARY_OBJECTS) > $(MUTANTS_WORK)/library.objects
	@echo $(UNIT_OBJECTS) $(TESTED) $(MUTANTS_LINK) $(TEST_LIBRARIES) > $(MUTANTS_WORK)/unit_tests.link
	@echo $(SITL_OBJECTS) $(LIBRARY) $(MUTANTS_LINK) $(TEST_LIBRARIES) > $(MUTANTS_WORK)/sitl_tests.link
	@echo $(B)/tools/screed/main.o $(LIBRARY) $(MUTANTS_LINK) > $(MUTANTS_WORK)/screed.link
	@python3 -B tools/mutants/mutants.py --build $(B) --work $(MUTANTS_WORK) --jobs $(shell nproc) $(ARGS)

test-mutants:  ## the mutation tool: what it changes, its tables, and a campaign on a small program
	@echo "  TEST tests/mutants"
	@python3 -B -m unittest discover -s tests/mutants -p '*_test.py'
test-long: test-mutants
