# Campaigns through a Slurm of their own. Included by the top Makefile.

.PHONY: test-slurm
test-slurm: $(SCREED)  ## a campaign through a real Slurm on this machine (as root)
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/slurm/slurm_test.sh
