# Tests with programs nobody here wrote: can-utils, python3-can, Debian's kernel. Included by the top Makefile.
#
#   make test-can
#
# Needs from there: B, SCREED, STEP, BUILD_ROOT. Every tests/can/*_test.sh is a test.

.PHONY: test-can run-test-can
test-can: deps
	$(STEP) run-test-can

run-test-can: $(SCREED) $(B)/telemetry_lab
	@SCREED_PROGRAM=$(abspath $(SCREED)) TELEMETRY_LAB_PROGRAM=$(abspath $(B)/telemetry_lab) \
	  SCREED_WIRESHARK_PROFILE=$(abspath $(GENERATED_FOLDER)/wireshark) SCREED_CAN_BUILD=$(abspath $(BUILD_ROOT)/can) DEPS=$(DEPS) tests/can/run.sh
