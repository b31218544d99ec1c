# The host program build/<BUILD>/screed: its sources, flags, generated headers and library. Included by the top
# Makefile.
#
# Needs options.mk and schema.mk. Gives LIBRARY, COMMAND_LINE, SCREED, LIBRARY_SOURCES, GENERATED, the rules that make
# objects, and $(link).

DATA_DIR := $(CURDIR)/host_sim/data
BOARDS_DIR := $(CURDIR)/boards
MODELS_DIR := $(CURDIR)/nn/models
FIRMWARE_DIR := $(abspath $(BUILD_ROOT))/firmware
REPORT_DIR := $(abspath $(BUILD_ROOT))/report
EXPERIMENT ?= host_sim/data/experiments/level_bed.ini
# MCU=no: a program without simavr, and so without `sim --hal mcu` and `parity`.
MCU ?= yes

# ---- sources ---------------------------------------------------------------------------------------------------------

# C++14 is what gcc-avr 5.4 understands: what reaches the microcontroller is compiled as such on the host too.
CORE_SOURCES := $(call sources,firmware nn/infer)
# Files that know simavr; without it, a stand-in that says so.
SIMAVR_SOURCES := $(call sources,host_sim/devices/mcu) $(wildcard host_sim/run/world/mcu_*.cpp)
WITHOUT_SIMAVR := host_sim/run/world/without_simavr.cpp
LEFT_OUT_yes := $(WITHOUT_SIMAVR)
LEFT_OUT_no := $(SIMAVR_SOURCES)
ifeq ($(LEFT_OUT_$(MCU)),)
$(error MCU=$(MCU): yes or no)
endif
# Kernels in instructions of x86 alone; other processors compute with the baseline's, which have the same bits.
LEFT_OUT_HERE := $(if $(filter x86_64,$(MACHINE)),,%avx2.cpp %avx512.cpp)
HOST_SOURCES := $(filter-out $(CORE_SOURCES) $(LEFT_OUT_$(MCU)) $(LEFT_OUT_HERE),$(call sources,hal/host host_sim nn))
# What every program's command line is read with; the smaller programs link it without the library.
COMMAND_LINE_SOURCES := $(call sources,tools/command_line)
PROGRAM_SOURCES := $(filter-out tools/screed/main.cpp,$(call sources,tools/screed))
# A subcommand is one file.
COMMAND_SOURCES := $(filter %_command.cpp,$(PROGRAM_SOURCES))
LIBRARY_SOURCES := $(CORE_SOURCES) $(HOST_SOURCES) $(COMMAND_LINE_SOURCES) $(PROGRAM_SOURCES)
LIBRARY := $(B)/libscreed.a
COMMAND_LINE := $(B)/libcommand_line.a
SCREED := $(B)/screed

# ---- flags, in response files: objects are rebuilt when they change, and pkg-config runs once ------------------------

WARNINGS := -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wold-style-cast -Wnon-virtual-dtor \
            -Woverloaded-virtual -Wdouble-promotion -Wimplicit-fallthrough -Werror
# GCC collects what it no longer needs only when it holds half a gigabyte: collecting is a tenth of its time.
GCC_HEAP = $(if $(findstring clang,$(CXX)),,--param=ggc-min-heapsize=524288)
# The same bits on every processor: no fused multiply-add, and Eigen adds in no order of its vector code.
COMMON_FLAGS = $(OPTIMISE_$(BUILD)) $(WARNINGS) -ffp-contract=off -DEIGEN_DONT_VECTORIZE -fno-math-errno -fPIC \
  -fvisibility=hidden -fvisibility-inlines-hidden -ffunction-sections -fdata-sections -I. \
  -I$(BUILD_ROOT)/generated

PACKAGES := eigen3 ode urdfdom tinyxml assimp hdf5 libpng libtiff-4 stb cairo inih CLI11 nlohmann_json libxxhash \
  ncursesw
TEST_PACKAGES := gtest_main mpfr
BENCH_PACKAGES := benchmark
# Headers of these are known to single files.
LINK_PACKAGES := zlib libzstd librsvg-2.0 sdl2

# Foreign headers are system headers (no warnings); behind the compiler's own, since a package may name /usr/include.
# Threads are for who links them: a compiler refuses headers that were compiled without (tools/build/headers).
package_flags = pkg-config --cflags $(1) | sed 's/-I/-idirafter /g; s/-pthread//g'
# Writes standard input to the target where it differs from what is there.
WRITE_CHANGED = cat > $@.new && { cmp -s $@.new $@ && rm $@.new || mv $@.new $@ ; }

$(B)/host.flags: FORCE | $(SYSROOT)
	@mkdir -p $(@D)
	@{ echo "-std=c++20 $(GCC_HEAP) $(COMMON_FLAGS) -I$(B)/generated -Ihost_sim/interface" ; \
	   $(call package_flags,$(PACKAGES) $(TEST_PACKAGES) $(BENCH_PACKAGES)) ; } | $(WRITE_CHANGED)
$(B)/firmware.flags: FORCE
	@mkdir -p $(@D)
	@echo "-std=c++14 $(COMMON_FLAGS)" | $(WRITE_CHANGED)
ODE_FOLDER := $(BUILD_ROOT)/ode_$(MACHINE)
# Elsewhere than on x86-64 Debian's ODE has fused multiply-add.
ODE := $(if $(filter x86_64,$(MACHINE)),,$(ODE_FOLDER)/lib/libode.a)
$(ODE_FOLDER)/lib/libode.a: tools/arm64/debian.sh | $(SYSROOT)
	@echo "  GET  source of ODE"
	@tools/arm64/debian.sh ode $(ODE_FOLDER) $(MACHINE)-linux-gnu
	@touch $@
$(B)/link.flags: FORCE | $(ODE)
	@mkdir -p $(@D)
	@{ echo "$(filter -fsanitize%,$(OPTIMISE_$(BUILD))) $(if $(ODE),-L$(dir $(ODE)))" ; \
	   pkg-config --libs $(PACKAGES) $(LINK_PACKAGES) ; \
	   echo "-lpagmo -lboost_serialization -ltbb $(if $(filter yes,$(MCU)),-lsimavr)" ; } | $(WRITE_CHANGED)

# Libraries whose headers are known to single files.
TINY_DNN_SOURCES := $(shell grep -rl '"nn/training/tiny_dnn.h"' --include='*.cpp' nn tools tests)
TINY_DNN_OBJECTS := $(call objects,$(TINY_DNN_SOURCES))
$(TINY_DNN_OBJECTS): EXTRA_FLAGS = -idirafter $(B)/tiny_dnn
$(TINY_DNN_OBJECTS): | $(B)/tiny_dnn/third_party/stb
# tiny-dnn looks for stb in a folder of its own sources, which Debian's package leaves out.
$(B)/tiny_dnn/third_party/stb: | $(SYSROOT)
	@mkdir -p $(@D)
	@ln -sfn "$$(pkg-config --variable=includedir stb)" $@
# Large matrices on which no world's bits depend: Eigen with its vector code, by another name, since a linker takes one
# of two that are called alike.
VECTOR_SOURCES := nn/training/predict.cpp nn/terrain/terrain_trainer.cpp tools/bench/speed/network_bench.cpp
$(call objects,$(VECTOR_SOURCES)): EXTRA_FLAGS += -UEIGEN_DONT_VECTORIZE -DEigen=EigenVectorised
# Headers that were compiled otherwise are of no use to them: gcc sees it, clang refuses.
$(call objects,$(VECTOR_SOURCES)): HEADERS_FLAGS =
RSVG_FLAGS = $(shell $(call package_flags,librsvg-2.0))
RSVG_SOURCES := host_sim/render/chart/svg.cpp
$(call objects,$(RSVG_SOURCES)): EXTRA_FLAGS = $(RSVG_FLAGS)
SDL_FLAGS = $(shell $(call package_flags,sdl2))
SDL_SOURCES := tools/screed/viewer/window.cpp tests/unit/tools/screed/viewer/gamepad_test.cpp
$(call objects,$(SDL_SOURCES)): EXTRA_FLAGS = $(SDL_FLAGS)

# ---- generated headers: what the program knows of its surroundings; only files that include them depend on them

BUILT_IN = ODE $$(pkg-config --modversion ode), HDF5 $$(pkg-config --modversion hdf5),
BUILT_IN += $(if $(filter yes,$(MCU)),simavr,no simavr (MCU=no))
$(B)/generated/version.h: FORCE
	@mkdir -p $(@D)
	@{ echo '#define SCREED_VERSION "$(VERSION)"' ; \
	   echo '#define SCREED_VERSION_TEXT "screed $(VERSION) ($(word 3,$(VERSION_WORDS)))"' ; \
	   echo "#define SCREED_BUILT_IN \"$(BUILT_IN)\"" ; } | $(WRITE_CHANGED)
$(B)/generated/paths.h: FORCE
	@mkdir -p $(@D)
	@{ echo '// Where the data of this build lies.' ; echo '#pragma once' ; echo 'namespace screed {' ; \
	   echo 'inline constexpr const char* kDataFolder = "$(DATA_DIR)";' ; \
	   echo 'inline constexpr const char* kBoardsFolder = "$(BOARDS_DIR)";' ; \
	   echo 'inline constexpr const char* kModelsFolder = "$(MODELS_DIR)";' ; \
	   echo 'inline constexpr const char* kFirmwareFolder = "$(FIRMWARE_DIR)";' ; \
	   echo 'inline constexpr const char* kReportFolder = "$(REPORT_DIR)";' ; echo '}' ; } | $(WRITE_CHANGED)
# The constants of every board, under their folders' names.
$(B)/generated/boards.h: FORCE
	@mkdir -p $(@D)
	@{ echo '// The boards of this build: for host_sim/run/experiment/board_table.cpp alone.' ; \
	   echo '#include "firmware/parameters/board_constants.h"' ; \
	   for board in $(BOARDS) ; do echo "#define kBoard kBoard_$$board" ; echo "#include \"boards/$$board/board.h\"" ; \
	     echo '#undef kBoard' ; done ; \
	   echo '#define SCREED_BOARDS(X) $(foreach board,$(BOARDS),X($(board)))' ; \
	   echo '#define SCREED_DEFAULT_BOARD "$(DEFAULT_BOARD)"' ; } | $(WRITE_CHANGED)
$(B)/generated/commands.h: FORCE
	@mkdir -p $(@D)
	@tools/build/commands.sh $(COMMAND_SOURCES) | $(WRITE_CHANGED)
GENERATED := $(B)/generated/version.h $(B)/generated/paths.h $(B)/generated/boards.h $(B)/generated/commands.h \
  $(SCHEMA_HEADERS)

# ---- headers of libraries, compiled once: a third to a half of a source's time goes into them ------------------------

# tools/build/headers/SET.h stands before the sources that $(call with_headers,SET,SOURCES) names. HEADERS=no does
# without, which shows in a clean build whether each source includes what it uses.
HEADERS ?= yes
ifeq ($(HEADERS),yes)
# Behind them GCC 12 takes `std::string(kText) + "more"` for a write out of bounds; clang does not know the second of
# the flags.
HEADERS_FLAGS = $(if $(HEADER_SET),-include $(B)/headers/$(HEADER_SET).h \
  $(if $(findstring clang,$(CXX)),,-Wno-array-bounds -Wno-stringop-overflow))
define with_headers
$(call objects,$(2)): HEADER_SET = $(1)
$(call objects,$(2)): $(B)/headers/$(1).h.gch
endef
else ifneq ($(HEADERS),no)
$(error HEADERS=$(HEADERS): yes or no)
endif
# A release is compiled with -O2 where it computes, and more quickly where it does not: what runs once in a run, and
# tests. A compiled header brings along the level that it was compiled with.
# Under the sanitizers, where compiling takes longest, neither is optimised.
SET_FLAGS_cold := $(if $(filter release,$(BUILD)),-O1,-O0)
SET_FLAGS_test := -O0
SET_FLAGS = $(SET_FLAGS_$(HEADER_SET))
COLD_SOURCES := $(COMMAND_LINE_SOURCES) $(PROGRAM_SOURCES) \
  $(filter $(addsuffix /%,$(addprefix host_sim/,campaign engine benchmark search soil_validation \
  ground_station/link ground_station/station ground_station/calibration run/experiment run/report run/comparison \
  render/chart render/report physics/vehicle/urdf)),$(HOST_SOURCES))

# Named without .gch on a command line, for which both compilers want the header itself beside it.
define headers_of_set
$(B)/headers/$(1).h.gch: HEADER_SET = $(1)
$(B)/headers/$(1).h.gch: tools/build/headers/$(2).h $(B)/host.flags
	@mkdir -p $$(@D)
	@echo "  CXX  $$< $$(SET_FLAGS)"
	@cp $$< $$(@:.gch=)
	@$$(CXX) @$(B)/host.flags $$(SET_FLAGS) $(if $(findstring clang,$(CXX)),-fpch-instantiate-templates) -x c++-header \
	  $$< -o $$@
endef
$(eval $(call headers_of_set,host,host))
$(eval $(call headers_of_set,cold,host))
$(eval $(call headers_of_set,test,test))
$(B)/headers/test.h.gch: tools/build/headers/host.h

# ---- groups: neighbouring sources are compiled as one, since they share most of what they include --------------------

# Kernels for several instruction sets give the same names; what mutation testing changes is compiled again and again;
# some need flags of their own.
ALONE := tools/command_line/% $(SIMAVR_SOURCES) \
         $(addsuffix /%,host_sim/physics/kernels host_sim/physics/particles nn/batch) \
         $(shell sed -nE 's/^((host_sim|nn)[^ ]*\.cpp) .*/\1/p' tools/mutants/targets.txt) \
         $(TINY_DNN_SOURCES) $(VECTOR_SOURCES) $(RSVG_SOURCES) $(SDL_SOURCES)
# Sources a group, at most. Larger ones save less where the compiler optimises, and who changes one source waits for all
# of its group.
GROUP_host := 8
GROUP_cold := 16
GROUP_test := 24
# $(call in_groups,SET,SOURCES,HEADERS,FLAGS,ALL): SET_OBJECTS are the objects of all of them. Tests' helpers, which are
# no *_test.cpp, stay alone. Where SOURCES are a part of ALL, their groups are parts of its groups.
define in_groups
$(call with_headers,$(3),$(2))
$(1)_ALONE := $(filter $(ALONE),$(2)) $(filter tests/%,$(filter-out %_test.cpp,$(2)))
$(1)_GROUPS := $$(shell printf '%s\n' $$(filter-out $(ALONE) $$($(1)_ALONE),$(or $(5),$(2))) | \
  awk -v most=$(GROUP_$(3)) -v only="$(if $(5),$(2))" -f tools/build/groups.awk)
$(1)_GROUP_OBJECTS := $$(foreach group,$$($(1)_GROUPS),$(B)/groups/$(1)/$$(firstword $$(subst :, ,$$(group))).o)
$(1)_OBJECTS := $$($(1)_GROUP_OBJECTS) $$(call objects,$$($(1)_ALONE))
$$($(1)_GROUP_OBJECTS): HEADER_SET = $(3)
$$($(1)_GROUP_OBJECTS): GROUP_FLAGS = $(4)
$$($(1)_GROUP_OBJECTS): $(if $(filter yes,$(HEADERS)),$(B)/headers/$(3).h.gch)
$$(foreach group,$$($(1)_GROUPS),$$(eval $(B)/groups/$(1)/$$(subst :,.cpp: ,$$(subst $$(comma), ,$$(group)))))
endef
comma := ,
$(B)/groups/%.cpp: tools/build/group.awk FORCE
	@mkdir -p $(@D)
	@awk -f tools/build/group.awk $(filter-out %.awk FORCE,$^) | $(WRITE_CHANGED)
$(B)/groups/%.o: $(B)/groups/%.cpp $(B)/host.flags | $(GENERATED)
	@echo "  CXX  $(notdir $*)"
	@$(CXX) @$(B)/host.flags $(GROUP_FLAGS) $(HEADERS_FLAGS) $(if $(findstring clang,$(CXX)),,-Wno-subobject-linkage) \
	  $(SET_FLAGS) -MMD -MP -c $< -o $@

$(eval $(call in_groups,HOT,$(filter-out $(COLD_SOURCES),$(HOST_SOURCES)),host))
$(eval $(call in_groups,COLD,$(COLD_SOURCES),cold))

# ---- objects, library, program ---------------------------------------------------------------------------------------

$(call objects,$(CORE_SOURCES)): $(B)/%.o: %.cpp $(B)/firmware.flags | $(SCHEMA_HEADERS)
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) @$(B)/firmware.flags -MMD -MP -c $< -o $@
$(B)/%.o: %.cpp $(B)/host.flags | $(GENERATED)
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	@$(CXX) @$(B)/host.flags $(HEADERS_FLAGS) $(SET_FLAGS) $(EXTRA_FLAGS) -MMD -MP -c $< -o $@

# A program of objects and archives, with more libraries: $(call link,LIBRARIES).
define link
	@echo "  LINK $@"
	@$(CXX) $(filter %.o %.a,$^) -Wl,--as-needed @$(B)/link.flags $(1) -o $@
	$(call runnable,$@)
endef

LIBRARY_OBJECTS := $(call objects,$(CORE_SOURCES)) $(HOT_OBJECTS) $(COLD_OBJECTS)
$(LIBRARY): $(LIBRARY_OBJECTS) $(B)/link.flags
	@rm -f $@
	@$(AR) rcs $@ $(filter %.o,$^)
$(COMMAND_LINE): $(call objects,$(COMMAND_LINE_SOURCES))
	@rm -f $@
	@$(AR) rcs $@ $^
$(SCREED): $(B)/tools/screed/main.o $(LIBRARY) $(B)/link.flags
	$(call link)

.PHONY: build sim level install uninstall
build: $(SCREED)  ## build/<BUILD>/screed, the host program (BUILD=release|debug|asan)
sim: $(SCREED)  ## a robot levels a small walled bed, a minute (EXPERIMENT=FILE ARGS='--seed 2 --duration 600')
	@$(SCREED) sim $(EXPERIMENT) $(ARGS)
# Into a folder that is new: what was there stays.
level: $(SCREED) $(REPORT_PAGE)  ## the same, and a page with a time slider (ARGS='--seed 2')
	@run=$(OUT)/level ; number=2 ; while [ -e $$run ] ; do run=$(OUT)/level-$$number ; number=$$((number + 1)) ; done ; \
	  $(SCREED) sim host_sim/data/experiments/level_bed.ini --heights --out $$run $(ARGS) && \
	  $(SCREED) report $$run

# What `make install` makes below PREFIX. The program finds its data from where it lies itself
# (host_sim/core/data_folders.h), so the tree may be moved.
INSTALLED_DATA := share/screed
INSTALLED_DOC := share/doc/screed
INSTALLED_RULES := lib/udev/rules.d/60-screed.rules
# Where Debian's shells look; zsh's place depends on who installs.
INSTALLED_BASH := share/bash-completion/completions/screed
INSTALLED_ZSH := share/zsh/$(if $(filter /usr,$(PREFIX)),vendor-completions,site-functions)/_screed
INSTALLED_FISH := share/fish/vendor_completions.d/screed.fish
INSTALLED_MAN := share/man/man1
# One word, since make takes blanks for the ends of names.
INTO = $(if $(word 2,$(DESTDIR)$(PREFIX)),$(error PREFIX and DESTDIR: no blanks),$(DESTDIR)$(PREFIX))
install:  ## install program, data, flash tool and docs (PREFIX=/usr/local)
install: $(SCREED) $(SCHEMA_HEADERS) $(BUILD_ROOT)/report/page.html
	install -D -m 755 -t $(INTO)/bin $(SCREED)
	install -D -m 755 tools/flash/flash.py $(INTO)/bin/screed_flash
	install -D -m 644 tools/flash/60-screed.rules $(INTO)/$(INSTALLED_RULES)
	@mkdir -p $(INTO)/$(INSTALLED_DATA) $(INTO)/$(INSTALLED_DOC)
	cp -r host_sim/data/. boards nn/models $(SCHEMA) $(GENERATED_FOLDER)/wireshark $(INTO)/$(INSTALLED_DATA)/
	install -D -m 644 -t $(INTO)/$(INSTALLED_DATA)/report $(BUILD_ROOT)/report/page.html
	cp -r README.md CHANGELOG.md LICENSE docs $(INTO)/$(INSTALLED_DOC)/
	@mkdir -p $(dir $(addprefix $(INTO)/,$(INSTALLED_BASH) $(INSTALLED_ZSH) $(INSTALLED_FISH)))
	$(SCREED) completion bash > $(INTO)/$(INSTALLED_BASH)
	$(SCREED) completion zsh > $(INTO)/$(INSTALLED_ZSH)
	$(SCREED) completion fish > $(INTO)/$(INSTALLED_FISH)
	$(SCREED) manual --out $(INTO)/$(INSTALLED_MAN)
	@for image in $(wildcard $(BUILD_ROOT)/firmware/*/screed.elf) ; do \
	   install -v -D -m 644 $$image $(INTO)/$(INSTALLED_DATA)/firmware/$$(basename $$(dirname $$image))/screed.elf ; done
uninstall:  ## remove what `make install` made (PREFIX=/usr/local)
	rm -rf $(addprefix $(INTO)/,bin/screed bin/screed_flash $(INSTALLED_RULES) $(INSTALLED_DATA) $(INSTALLED_DOC) \
	  $(INSTALLED_BASH) $(INSTALLED_ZSH) $(INSTALLED_FISH) $(INSTALLED_LIBRARIES)) \
  $(wildcard $(INTO)/$(INSTALLED_MAN)/screed*.1)

# ---- clangd ----------------------------------------------------------------------------------------------------------

# clangd looks for it in build/ by itself.
.PHONY: compile-commands
compile-commands: $(BUILD_ROOT)/compile_commands.json  ## what clangd and other tools need to know of the flags
$(BUILD_ROOT)/compile_commands.json: $(B)/host.flags $(B)/firmware.flags $(GENERATED) FORCE
	@{ for source in $(CORE_SOURCES) ; do echo "$$source $(B)/firmware.flags" ; done ; \
	   for source in $(filter-out $(CORE_SOURCES),$(ALL_HOST_SOURCES)) ; do echo "$$source $(B)/host.flags" ; done ; } \
	   | awk -v folder='$(CURDIR)' -v cxx='$(CXX)' -v extra='-idirafter $(B)/tiny_dnn $(RSVG_FLAGS) $(SDL_FLAGS)' \
	     -f tools/build/compile_commands.awk | $(WRITE_CHANGED)
