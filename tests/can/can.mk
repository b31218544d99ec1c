# Tests with programs nobody here wrote: can-utils, python3-can, Debian's kernel. Included by the top Makefile.
#
# Every tests/can/*_test.sh is a test. What is not installed is skipped, and said; with CI=true that is a failure.

.PHONY: test-can
test-can: $(SCREED) $(TELEMETRY_LAB)  ## telemetry with candump, slcand, python-can and a real CAN kernel (in QEMU)
	@SCREED_PROGRAM=$(abspath $(SCREED)) TELEMETRY_LAB_PROGRAM=$(abspath $(B)/telemetry_lab) \
	  SCREED_WIRESHARK_PROFILE=$(abspath $(GENERATED_FOLDER)/wireshark) SCREED_CAN_BUILD=$(abspath $(BUILD_ROOT)/can) \
	  tests/can/run.sh
