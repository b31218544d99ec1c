# Options of a build that every part reads, and where things lie. Included first by the top Makefile.

BUILD ?= release
# The board that the programs mean when none is named, whatever this build is for.
DEFAULT_BOARD := a_star_32u4
BOARD ?= $(DEFAULT_BOARD)
ARGS ?=
PREFIX ?= /usr/local

BUILD_ROOT := build
OUT := out
B := $(BUILD_ROOT)/$(BUILD)
# NUMBER COMMIT DATE.
VERSION_WORDS := $(shell tools/build/version.sh)
ifneq ($(words $(VERSION_WORDS)),3)
$(error tools/build/version.sh knows no version)
endif
COMMIT := $(word 2,$(VERSION_WORDS))
VERSION := $(firstword $(VERSION_WORDS))$(if $(filter-out unknown,$(COMMIT)),+$(COMMIT))

OPTIMISE_release := -O2 -DNDEBUG
OPTIMISE_debug := -O0 -g
OPTIMISE_asan := -O1 -gline-tables-only -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
OPTIMISE_arm64 := $(OPTIMISE_release)
ifeq ($(OPTIMISE_$(BUILD)),)
$(error BUILD=$(BUILD): release, debug, asan or arm64)
endif
# The compiler of programs that the build itself runs.
HERE_CXX := $(CXX)
OBJCOPY := objcopy
ifeq ($(BUILD),arm64)
include tools/arm64/arm64.mk
endif
MACHINE := $(firstword $(subst -, ,$(shell $(CXX) -dumpmachine)))

# A board is a folder with a board.mk.
BOARDS := $(patsubst boards/%/board.mk,%,$(sort $(wildcard boards/*/board.mk)))
ifeq ($(filter $(BOARD),$(BOARDS)),)
$(error BOARD=$(BOARD): no folder boards/$(BOARD) with a board.mk; there are: $(BOARDS))
endif

# Sources below folders, at any depth: $(call sources,FOLDER...).
sources = $(if $(strip $(1)),$(shell find $(1) -name '*.cpp' | LC_ALL=C sort))
objects = $(patsubst %.cpp,$(B)/%.o,$(1))

.PHONY: FORCE
