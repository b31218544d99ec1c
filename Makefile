# Screed: every entry point. `make help` lists them.
#
# The first call on a fresh machine installs what is missing (DEPS=no switches that off), so rules that need installed tools run in a
# second make, after the check. Everything is built under build/, results go to out/.

SHELL := /bin/bash
.SHELLFLAGS := -o pipefail -ec
.DELETE_ON_ERROR:
MAKEFLAGS += --no-builtin-rules
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += -j$(shell nproc)
endif

BUILD ?= release
DEPS ?= yes
BOARD ?= a_star_32u4
EXPERIMENT ?= host_sim/data/experiments/first_drive.ini
SESSIONS ?= $(wildcard host_sim/data/experiments/sessions/*.ini)
ARGS ?=
PREFIX ?= /usr/local

BUILD_ROOT := build
OUT := out
B := $(BUILD_ROOT)/$(BUILD)

OPTIMISE_release := -O2 -DNDEBUG
OPTIMISE_debug := -O0 -g
OPTIMISE_asan := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
ifeq ($(OPTIMISE_$(BUILD)),)
$(error BUILD=$(BUILD): release, debug or asan)
endif

# -ffp-contract=off: the same bits with and without fused multiply-add.
WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wold-style-cast -Wnon-virtual-dtor \
            -Woverloaded-virtual -Wdouble-promotion -Wimplicit-fallthrough -Werror
COMMON_FLAGS = $(OPTIMISE_$(BUILD)) $(WARNINGS) -ffp-contract=off -fno-math-errno -I. -I$(BUILD_ROOT)/generated
DATA_DIR ?= $(CURDIR)/host_sim/data
BOARDS_DIR ?= $(CURDIR)/boards
MODELS_DIR ?= $(CURDIR)/nn/models
FIRMWARE_DIR ?= $(abspath $(BUILD_ROOT))/firmware
# MCU=no: a program without simavr, and so without `sim --hal mcu` and `parity`.
MCU ?= yes
VERSION := $(shell git describe --always --dirty 2>/dev/null || echo unknown)

PACKAGES := eigen3 ode urdfdom tinyxml assimp hdf5 libpng stb cairo inih CLI11 nlohmann_json libxxhash ncursesw
TEST_PACKAGES := gtest_main
BENCH_PACKAGES := benchmark
# Headers of these are known to single files.
LINK_PACKAGES := zlib librsvg-2.0 sdl2

# C++14 is what gcc-avr 5.4 understands: what reaches the microcontroller is compiled as such on the host too.
CORE_SOURCES := $(wildcard firmware/*.cpp firmware/*/*.cpp firmware/leveling/grid/*.cpp nn/infer/*.cpp)
MCU_SOURCES := $(wildcard host_sim/mcu/*.cpp)
MCU_STAND_IN := host_sim/mcu/without_simavr.cpp
MCU_USED_yes := $(filter-out $(MCU_STAND_IN),$(MCU_SOURCES))
MCU_USED_no := $(MCU_STAND_IN) host_sim/mcu/default_image.cpp host_sim/mcu/parity.cpp
ifeq ($(MCU_USED_$(MCU)),)
$(error MCU=$(MCU): yes or no)
endif
HOST_SOURCES := $(filter-out $(MCU_SOURCES),$(wildcard hal/host/*.cpp host_sim/*/*.cpp nn/model/*.cpp nn/batch/*.cpp nn/data/*.cpp nn/training/*.cpp nn/surrogate/*.cpp nn/terrain/*.cpp nn/slip/*.cpp)) $(MCU_USED_$(MCU))
TOOL_SOURCES := $(filter-out tools/main.cpp,$(wildcard tools/*.cpp tools/viewer/*.cpp))
LIBRARY_SOURCES := $(CORE_SOURCES) $(HOST_SOURCES) $(TOOL_SOURCES)
SCHEMA_LIBRARY_SOURCES := $(filter-out tools/schema/main.cpp,$(wildcard tools/schema/*.cpp))
LAB_LIBRARY_SOURCES := $(filter-out tools/telemetry_lab/main.cpp,$(wildcard tools/telemetry_lab/*.cpp))
STACK_LIBRARY_SOURCES := $(filter-out tools/avr_stack/main.cpp,$(wildcard tools/avr_stack/*.cpp))
UNIT_SOURCES := $(wildcard tests/unit/*.cpp)
SITL_SOURCES := $(wildcard tests/sitl/*.cpp)
BENCH_SOURCES := $(wildcard tools/bench/*.cpp)
TERRAIN_BENCH_SOURCES := $(wildcard tools/bench/terrain/*.cpp)
CPP_FILES := $(shell find firmware hal host_sim nn tools tests boards -name '*.cpp' -o -name '*.h' 2>/dev/null | LC_ALL=C sort)
TIDY_SOURCES := $(LIBRARY_SOURCES) $(STACK_LIBRARY_SOURCES) $(SCHEMA_LIBRARY_SOURCES) tools/main.cpp tools/schema/main.cpp \
                $(LAB_LIBRARY_SOURCES) tools/telemetry_lab/main.cpp $(wildcard tools/avr_stack/main.cpp) \
                $(UNIT_SOURCES) $(SITL_SOURCES) $(BENCH_SOURCES) $(TERRAIN_BENCH_SOURCES)

objects = $(patsubst %.cpp,$(B)/%.o,$(1))
SCREED := $(B)/screed
LIBRARY := $(B)/libscreed.a

# ---- entry points -----------------------------------------------------------------------------------------------------------

.PHONY: help sim test firmware size bench bench-terrain soil-same-bits lint format deps clean install build FORCE
.DEFAULT_GOAL := help

help:
	@echo "make sim       drive the robot over a real terrain   (EXPERIMENT=FILE ARGS='--seed 2 --duration 30')"
	@echo "make sessions  record the thesis' training sessions into out/sessions (SESSIONS='FILE...' ARGS='--frames 800')"
	@echo "make surrogate-v3  record V3's sessions, train it, drive it beside the physics (two hours; FRAMES=800 ARGS='--steps 20': short)"
	@echo "make terrain-tracks  train what tracks do to the ground of the surrogate world, on V3's sessions (half an hour; FRAMES, ARGS)"
	@echo "make surrogate  train, evaluate and export the networks of the thesis  (MODELS='v1 v2' FRAMES=4000 ARGS='--epochs 2')"
	@echo "make test      build and run every test               (BUILD=asan: under the sanitizers)"
	@echo "make test-can  telemetry with candump, slcand, python-can and a real CAN kernel (in QEMU)"
	@echo "make firmware  build the image for the robot          (BOARD=$(BOARD))"
	@echo "make size      flash, RAM, stack and longest tick of that image against the budget"
	@echo "make arduino   the firmware as a library for the Arduino IDE (BOARD=$(BOARD))"
	@echo "make flash     build it and bring it onto the board (BOARD=$(BOARD) PORT=/dev/ttyACM0)"
	@echo "make fuses     the fuses the board should have       (PROGRAMMER=avr109|NAME: compare; WRITE=yes: write)"
	@echo "make monitor   serial monitor on the board           (PORT=/dev/ttyACM0)"
	@echo "make bench     real-time factor and ns per tick"
	@echo "make bench-decode  frames a second of screed decode, beside tshark"
	@echo "make damage    wrong frames that damaged lines of the radio bring forth"
	@echo "make fuzz      fuzz everything that reads bytes      (EXECUTIONS=200000)"
	@echo "make bench-terrain  time and memory of a frame on every terrain, beside the thesis'"
	@echo "make soil-same-bits  the soil compiled with -O1 and -O3 leaves the same bytes"
	@echo "make lint      formatting and static analysis"
	@echo "make format    clang-format over the tree"
	@echo "make build     build/$(BUILD)/screed, the host program (BUILD=release|debug|asan)"
	@echo "make install   install it                             (PREFIX=$(PREFIX))"
	@echo "make deps      install missing Debian packages        (DEPS=no: never)"
	@echo "make clean     remove build/ (results in out/ stay)"

# Each of these needs the packages first and then knows how to go on.
STEP = +@$(MAKE) --no-print-directory BUILD=$(BUILD) BOARD=$(BOARD) DEPS=no
sim: deps
	$(STEP) run-sim
sessions: deps
	$(STEP) run-sessions
test: deps
	$(STEP) run-tests
firmware: deps
	$(STEP) firmware-image
size: deps
	$(STEP) firmware-size
	$(STEP) firmware-cycles
bench: deps
	$(STEP) run-bench
bench-terrain: deps
	$(STEP) run-bench-terrain
soil-same-bits: deps
	$(STEP) run-soil-same-bits
lint: deps
	$(STEP) -k run-lint
build: deps
	$(STEP) $(SCREED)

deps:
	@tools/install-deps.sh $(DEPS) tools/debian-packages.txt

format: deps
	clang-format -i $(CPP_FILES)

clean:
	rm -rf $(BUILD_ROOT)

include tools/schema/schema.mk

# ---- compiler flags in response files: rebuilt when they change, and pkg-config runs once. -idirafter: foreign headers
# are system headers (no warnings), and a package that names /usr/include does not upset the compiler's own order ------------------------------------

$(B)/host.flags: FORCE
	@mkdir -p $(@D)
	@{ echo "-std=c++20 $(COMMON_FLAGS) -I$(B)/generated" ; \
	   pkg-config --cflags $(PACKAGES) $(TEST_PACKAGES) $(BENCH_PACKAGES) | sed 's/-I/-idirafter /g' ; } > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@
$(B)/firmware.flags: FORCE
	@mkdir -p $(@D)
	@echo "-std=c++14 $(COMMON_FLAGS)" > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@
$(B)/link.flags: FORCE
	@mkdir -p $(@D)
	@{ echo "$(filter -fsanitize%,$(OPTIMISE_$(BUILD)))" ; pkg-config --libs $(PACKAGES) $(LINK_PACKAGES) ; \
	   echo "$(if $(filter yes,$(MCU)),-lsimavr)" ; } > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@
# What the program knows of its surroundings; only the files that include them depend on them.
$(B)/generated/version.h: FORCE
	@mkdir -p $(@D)
	@echo '#define SCREED_VERSION "$(VERSION)"' > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@
$(B)/generated/paths.h: FORCE
	@mkdir -p $(@D)
	@{ echo '// Where the data of this build lies.' ; echo 'namespace screed {' ; \
	   echo 'inline constexpr const char* kDataFolder = "$(DATA_DIR)";' ; \
	   echo 'inline constexpr const char* kBoardsFolder = "$(BOARDS_DIR)";' ; \
	   echo 'inline constexpr const char* kModelsFolder = "$(MODELS_DIR)";' ; \
	   echo 'inline constexpr const char* kFirmwareFolder = "$(FIRMWARE_DIR)";' ; echo '}' ; } > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@
# The constants of every board, under their folders' names.
BOARDS := $(patsubst boards/%/board.h,%,$(wildcard boards/*/board.h))
$(B)/generated/boards.h: FORCE
	@mkdir -p $(@D)
	@{ echo '// The boards of this build: for host_sim/experiment/board_table.cpp alone.' ; \
	   echo '#include "firmware/robot/board_constants.h"' ; \
	   for board in $(BOARDS) ; do echo "#define kBoard kBoard_$$board" ; echo "#include \"boards/$$board/board.h\"" ; \
	     echo '#undef kBoard' ; done ; \
	   echo '#define SCREED_BOARDS(X) $(foreach board,$(BOARDS),X($(board)))' ; } > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@
# tiny-dnn looks for stb in a folder of its own sources, which Debian's package leaves out.
$(B)/tiny_dnn/third_party/stb:
	@mkdir -p $(@D)
	@ln -sfn "$$(pkg-config --variable=includedir stb)" $@
GENERATED := $(B)/generated/version.h $(B)/generated/paths.h $(B)/generated/boards.h $(SCHEMA_HEADERS)

# ---- host program ------------------------------------------------------------------------------------------------------------

$(call objects,$(CORE_SOURCES)): $(B)/%.o: %.cpp $(B)/firmware.flags | $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) @$(B)/firmware.flags -MMD -MP -c $< -o $@
$(B)/%.o: %.cpp $(B)/host.flags | $(GENERATED)
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) @$(B)/host.flags $(EXTRA_FLAGS) -MMD -MP -c $< -o $@
# tiny-dnn for the files that know it.
TINY_DNN_FILES := $(shell grep -l '"nn/training/tiny_dnn.h"' nn/training/*.cpp tools/bench/*.cpp)
$(TINY_DNN_FILES:%.cpp=$(B)/%.o): EXTRA_FLAGS = -idirafter $(B)/tiny_dnn
$(TINY_DNN_FILES:%.cpp=$(B)/%.o): | $(B)/tiny_dnn/third_party/stb
# librsvg's flags for the one file that knows it.
RSVG_FLAGS = $(shell pkg-config --cflags librsvg-2.0 | sed 's/-I/-idirafter /g')
$(B)/host_sim/picture/svg_png.o: EXTRA_FLAGS = $(RSVG_FLAGS)

# SDL's, likewise.
SDL_FLAGS = $(shell pkg-config --cflags sdl2 | sed 's/-I/-idirafter /g')
$(B)/tools/viewer/window.o: EXTRA_FLAGS = $(SDL_FLAGS)

$(LIBRARY): $(call objects,$(LIBRARY_SOURCES)) $(B)/link.flags
	@rm -f $@
	@ar rcs $@ $(filter %.o,$^)
$(B)/libavr_stack.a: $(call objects,$(STACK_LIBRARY_SOURCES))
	@rm -f $@
	@ar rcs $@ $^

$(SCREED): $(B)/tools/main.o $(LIBRARY) $(B)/link.flags
	@echo "  LINK $@"
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags -o $@

$(B)/avr_stack: $(B)/tools/avr_stack/main.o $(B)/libavr_stack.a $(B)/link.flags
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags -o $@

.PHONY: run-sim
run-sim: $(SCREED)
	@$(SCREED) sim $(EXPERIMENT) $(ARGS)
.PHONY: sessions run-sessions
run-sessions: $(SCREED)
	@$(SCREED) record $(SESSIONS) --out $(OUT)/sessions $(ARGS)

# V3's sessions, its training and its rollouts, and the training of what tracks do to the ground. Sessions that are there already are
# not recorded again. Short runs of everything:
#
#   make surrogate-v3 FRAMES=800 ARGS='--steps 20'
#   make terrain-tracks FRAMES=800 ARGS='--generations 1 --seconds 2'
.PHONY: surrogate-v3 run-surrogate-v3 run-v3-sessions
V3_SESSIONS := $(sort $(wildcard host_sim/data/experiments/sessions/v3/*.ini))
V3_OUT := $(OUT)/sessions/v3$(if $(FRAMES),-$(FRAMES))
run-v3-sessions: $(SCREED)
	@set -e ; for file in $(V3_SESSIONS) ; do session=$(V3_OUT)/$$(basename $$file .ini)-0001 ; \
	  test -e $$session/session.h5 || $(SCREED) record $$file --out $$session $(if $(FRAMES),--frames $(FRAMES)) ; done
surrogate-v3: deps
	$(STEP) run-surrogate-v3
run-surrogate-v3: run-v3-sessions
	@$(SCREED) nn motion nn/configurations/v3.json --sessions $(V3_OUT) --out $(OUT)/v3.json $(ARGS)
	@$(SCREED) nn rollout $(V3_OUT)/e_*-0001 --model $(OUT)/v3.json --fit $(V3_OUT)/t_viper-0001 \
	   --fit $(V3_OUT)/t_dry_sand-0001 --fit $(V3_OUT)/t_clay-0001 --out $(OUT)/rollouts

.PHONY: terrain-tracks run-terrain-tracks
terrain-tracks: deps
	$(STEP) run-terrain-tracks
run-terrain-tracks: run-v3-sessions
	@$(SCREED) terrain-net train-tracks $(V3_OUT)/t_*-0001 --out $(OUT)/terrain_tracks.json $(ARGS) \
	   --test $(V3_OUT)/e_ding_2011_b-0001 --test $(V3_OUT)/e_lete_sand_b-0001
	@$(SCREED) terrain-net compare $(OUT)/terrain_tracks.json $(V3_OUT)/e_ding_2011_b-0001 $(V3_OUT)/e_lete_sand_b-0001 \
	   --from $(if $(FRAMES),2,10) --pictures $(OUT)/terrain

install:
	$(STEP) BUILD=release BUILD_ROOT=$(BUILD_ROOT)/installed DATA_DIR=$(PREFIX)/share/screed BOARDS_DIR=$(PREFIX)/share/screed/boards MODELS_DIR=$(PREFIX)/share/screed/models FIRMWARE_DIR=$(PREFIX)/share/screed/firmware run-install
	@for image in $(wildcard $(BUILD_ROOT)/firmware/*/screed.elf) ; do \
	   install -v -D -m 644 $$image $(DESTDIR)$(PREFIX)/share/screed/firmware/$$(basename $$(dirname $$image))/screed.elf ; done
.PHONY: run-install
run-install: $(SCREED)
	install -D -m 755 $(SCREED) $(DESTDIR)$(PREFIX)/bin/screed
	mkdir -p $(DESTDIR)$(PREFIX)/share/screed
	cp -r host_sim/data/. boards nn/models $(SCHEMA) $(GENERATED_FOLDER)/wireshark $(DESTDIR)$(PREFIX)/share/screed/

# ---- the image for the microcontroller ---------------------------------------------------------------------------------------

include hal/avr/firmware.mk
include $(wildcard tools/arduino/arduino.mk)

# ---- tests -------------------------------------------------------------------------------------------------------------------

TESTS := $(B)/tests/unit_tests $(B)/tests/sitl_tests
ifeq ($(MCU),yes)
include $(wildcard tests/mcu/mcu_tests.mk)
endif
include tools/flash/flash.mk
include tools/telemetry_lab/telemetry_lab.mk
include tests/fuzz/fuzz.mk
include tests/can/can.mk
include nn/training/training.mk

$(B)/tests/unit_tests: $(call objects,$(UNIT_SOURCES) $(SCHEMA_LIBRARY_SOURCES) $(LAB_LIBRARY_SOURCES)) $(LIBRARY) $(B)/libavr_stack.a $(B)/link.flags
	@echo "  LINK $@"
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags $$(pkg-config --libs $(TEST_PACKAGES)) -o $@
$(B)/tests/sitl_tests: $(call objects,$(SITL_SOURCES)) $(LIBRARY) $(B)/link.flags
	@echo "  LINK $@"
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags $$(pkg-config --libs $(TEST_PACKAGES)) -o $@

.PHONY: run-tests
run-tests: $(SCREED) $(TESTS) $(TEST_IMAGES)
	@SCREED_PROGRAM=$(abspath $(SCREED)) tests/run.sh $(TESTS)

# ---- benchmarks --------------------------------------------------------------------------------------------------------------

$(B)/bench: $(call objects,$(BENCH_SOURCES)) $(LIBRARY) $(B)/link.flags
	@echo "  LINK $@"
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags $$(pkg-config --libs $(BENCH_PACKAGES)) -lfixedfann -o $@
.PHONY: run-bench
run-bench: $(B)/bench
	@$(B)/bench --benchmark_counters_tabular=true $(ARGS)

$(B)/terrain_bench: $(call objects,$(TERRAIN_BENCH_SOURCES)) $(LIBRARY) $(B)/link.flags
	@echo "  LINK $@"
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags -o $@
.PHONY: run-bench-terrain
run-bench-terrain: $(B)/terrain_bench
	@$(B)/terrain_bench --out $(OUT)/bench-terrain $(ARGS)

.PHONY: run-soil-same-bits
run-soil-same-bits: $(SCREED)
	@tools/soil_same_bits.sh $(B)

# ---- lint --------------------------------------------------------------------------------------------------------------------

# Sources whose object, flags or checks changed since they were last found clean, as many at a time as go together.
.PHONY: run-lint check-format
run-lint: check-format check-telemetry-page $(call objects,$(TIDY_SOURCES)) $(B)/lint.flags
	@tools/lint/run.sh $(B) $(TIDY_SOURCES)
	@echo "lint: $(words $(TIDY_SOURCES)) sources clean"
check-format:
	@clang-format --dry-run -Werror $(CPP_FILES)
$(B)/lint.flags: $(B)/host.flags | $(B)/tiny_dnn/third_party/stb
	@echo "$$(cat $<) -idirafter $(B)/tiny_dnn $(RSVG_FLAGS) $(SDL_FLAGS)" > $@

# One of them.
$(B)/%.tidy: %.cpp $(B)/%.o $(B)/firmware.flags $(B)/lint.flags .clang-tidy
	@tools/lint/run.sh $(B) $<

ALL_OBJECTS := $(call objects,$(LIBRARY_SOURCES) $(STACK_LIBRARY_SOURCES) $(SCHEMA_LIBRARY_SOURCES) $(LAB_LIBRARY_SOURCES) tools/telemetry_lab/main.cpp tools/main.cpp tools/avr_stack/main.cpp $(UNIT_SOURCES) \
                 $(SITL_SOURCES) $(BENCH_SOURCES) $(TERRAIN_BENCH_SOURCES))
-include $(ALL_OBJECTS:.o=.d)
