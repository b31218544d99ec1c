# Recording of training data, and training on it. `make surrogate`: the thesis' training sessions, networks V1 and V2
# trained on them, evaluated, quantised, exported. Results in out/.
#
#   make surrogate FRAMES=4000 ARGS='--epochs 2'    a short run of everything
#   make surrogate MODELS=v1                        one of nn/configurations
#
# Sessions that are there already are not recorded again. Needs host.mk.

MODELS ?= v1 v2 v2_tuned v2_products v2_forward v2_gyro
SURROGATE_SESSIONS ?= $(sort $(wildcard host_sim/data/experiments/sessions/v1_*.ini \
  host_sim/data/experiments/sessions/v2_*.ini))

.PHONY: surrogate
surrogate:  ## train, evaluate and export the networks of the thesis (MODELS='v1 v2' FRAMES=4000 ARGS='--epochs 2')
surrogate: $(SCREED)
	@set -e ; for file in $(SURROGATE_SESSIONS) ; do session=$(OUT)/sessions/$$(basename $$file .ini) ; \
	  ls $$session/session.h5 $$session-[0-9]*/session.h5 > /dev/null 2>&1 || \
	    $(SCREED) record $$file --out $$session $(if $(FRAMES),--frames $(FRAMES)) ; done
	@set -e ; for model in $(MODELS) ; do \
	  echo "== $$model" ; \
	  $(SCREED) nn train nn/configurations/$$model.json --sessions $(OUT)/sessions --out $(OUT)/nn/$$model $(ARGS) ; \
	  $(SCREED) nn eval $(OUT)/nn/$$model/model.json nn/configurations/$$model.json --sessions $(OUT)/sessions \
	    --out $(OUT)/nn/$$model/charts > $(OUT)/nn/$$model/evaluation.txt ; \
	  $(SCREED) nn eval $(OUT)/nn/$$model/model.json nn/configurations/$$model.json --sessions $(OUT)/sessions \
	    --markdown > $(OUT)/nn/$$model/evaluation.md ; \
	  $(SCREED) nn check $(OUT)/nn/$$model/model.json --vectors 100000 ; \
	  $(SCREED) nn export $(OUT)/nn/$$model/model.json --header $(OUT)/nn/$$model/model.h ; done
	@{ cat nn/training/results_head.txt ; \
	  for model in $(MODELS) ; do cat $(OUT)/nn/$$model/evaluation.md ; echo ; done ; } > $(OUT)/nn/results.md
	@echo "tables in $(OUT)/nn/results.md"

# ---- the thesis' sessions alone --------------------------------------------------------------------------------------

SESSIONS ?= $(wildcard host_sim/data/experiments/sessions/*.ini)
.PHONY: sessions
sessions: $(SCREED)  ## record the thesis' training sessions into out/sessions (SESSIONS='FILE...' ARGS='--frames 800')
	@$(SCREED) record $(SESSIONS) --out $(OUT)/sessions $(ARGS)

# ---- the stand-in beside recorded drives -----------------------------------------------------------------------------

STANDIN := host_sim/data/experiments/sessions/standin/standin
STANDIN_OUT := $(OUT)/sessions/standin$(if $(FRAMES),-$(FRAMES))
.PHONY: standin-check
standin-check:  ## record drives and judge the stand-in beside them (5 minutes;
##   ROWS='c_*': those of the choice; short: FRAMES=6000)
standin-check: $(SCREED)
	@$(SCREED) record $(STANDIN).ini --table $(STANDIN).csv --rows '$(or $(ROWS),e_*)' --missing --out $(STANDIN_OUT) \
	   $(if $(FRAMES),--frames $(FRAMES))
	@for drive in tracks firmware ; \
	  do $(SCREED) nn rollout $(STANDIN_OUT)/$(or $(ROWS),e_*)-0001 --drive $$drive $(ARGS) ; done
	@$(SCREED) nn ground $(STANDIN_OUT)/$(or $(ROWS),e_*)-0001
