# Tests with programs nobody here wrote: can-utils, python3-can, Debian's kernel. Included by the top Makefile.
#
#   make test-can
#
# What is not installed and cannot be is skipped, and said.
# Needs from there: B, SCREED, STEP, BUILD_ROOT, DEPS. Every tests/can/*_test.sh is a test.

.PHONY: test-can run-test-can
test-can: deps
	@tools/install-deps.sh $(DEPS) tests/can/debian-packages.txt || true
	$(STEP) run-test-can

run-test-can: $(SCREED) $(B)/telemetry_lab
	@SCREED_PROGRAM=$(abspath $(SCREED)) TELEMETRY_LAB_PROGRAM=$(abspath $(B)/telemetry_lab) \
	  SCREED_WIRESHARK_PROFILE=$(abspath $(GENERATED_FOLDER)/wireshark) SCREED_CAN_BUILD=$(abspath $(BUILD_ROOT)/can) tests/can/run.sh
