# Tests with programs nobody here wrote: can-utils, python3-can, Debian's kernel. Included by the top Makefile.
#
#   make test-can
#
# Needs from there: B, SCREED, STEP, BUILD_ROOT. Every tests/can/*_test.sh is a test.

.PHONY: test-can run-test-can
test-can: deps
	$(STEP) run-test-can

run-test-can: $(SCREED)
	@SCREED_PROGRAM=$(abspath $(SCREED)) SCREED_CAN_BUILD=$(abspath $(BUILD_ROOT)/can) DEPS=$(DEPS) tests/can/run.sh
