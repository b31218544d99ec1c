# The image for the robot's microcontroller, and its budget. Included by the top Makefile.
#
#   make firmware [BOARD=...]   builds build/firmware/<board>/screed.elf and .hex, prints the budget
#   make size [BOARD=...]       prints the budget again
#
# Needs from there: B and BUILD_ROOT (folders), $(B)/avr_stack (tools/avr_stack), FORCE. A board is a folder boards/<board>
# with board.h, pins.h and board.mk.

BOARD ?= a_star_32u4
ifeq ($(wildcard boards/$(BOARD)/board.mk),)
$(error BOARD=$(BOARD): no folder boards/$(BOARD) with a board.mk; there are: $(patsubst boards/%/board.mk,%,$(wildcard boards/*/board.mk)))
endif
include boards/$(BOARD)/board.mk

AVR_CXX ?= avr-g++
AVR_OBJCOPY ?= avr-objcopy
AVR_OBJDUMP ?= avr-objdump
AVR_SIZE ?= avr-size

# Most flash and RAM a program may use; RAM counts variables and the worst-case stack.
FLASH_BUDGET := 28672
RAM_BUDGET := 2560

FIRMWARE_BUILD := $(BUILD_ROOT)/firmware/$(BOARD)
FIRMWARE_ELF := $(FIRMWARE_BUILD)/screed.elf
FIRMWARE_SOURCES := $(sort $(wildcard firmware/*.cpp firmware/*/*.cpp hal/avr/*.cpp))
FIRMWARE_OBJECTS := $(FIRMWARE_SOURCES:%.cpp=$(FIRMWARE_BUILD)/%.o)

# No jump tables: they are indirect jumps, which the stack analysis refuses. -mrelax, -mstrict-X and no motion of loop
# invariants make gcc-avr 5.4's code smaller and the frames shallower (docs/firmware-budget.md).
AVR_FLAGS := -std=c++14 -Os -mmcu=$(BOARD_MCU) -DF_CPU=$(BOARD_CLOCK_HZ)UL -flto -fno-fat-lto-objects \
  -fno-exceptions -fno-rtti -fno-threadsafe-statics -fno-jump-tables -ffunction-sections -fdata-sections \
  -mrelax -mstrict-X -fno-move-loop-invariants
AVR_WARNINGS := -Wall -Wextra -Wconversion -Wshadow -Werror
AVR_INCLUDES := -I. -Iboards/$(BOARD)
AVR_LINK := -Wl,--gc-sections

.PHONY: firmware-image firmware-size
firmware-image: $(FIRMWARE_BUILD)/screed.hex firmware-size

firmware-size: $(FIRMWARE_BUILD)/screed.lst $(FIRMWARE_BUILD)/screed.size $(B)/avr_stack
	@echo "$(FIRMWARE_ELF)"
	@$(B)/avr_stack $(FIRMWARE_BUILD)/screed.lst --sizes $(FIRMWARE_BUILD)/screed.size \
	  --flash-budget $(FLASH_BUDGET) --ram-budget $(RAM_BUDGET)

# Changes only when compiler or flags do, and then everything is built anew.
$(FIRMWARE_BUILD)/avr.flags: FORCE
	@mkdir -p $(@D)
	@echo '$(AVR_CXX) $(AVR_FLAGS) $(AVR_WARNINGS) $(AVR_INCLUDES) $(AVR_LINK)' > $@.new
	@cmp -s $@.new $@ && rm $@.new || mv $@.new $@

$(FIRMWARE_BUILD)/%.o: %.cpp $(FIRMWARE_BUILD)/avr.flags
	@mkdir -p $(@D)
	@echo "  AVR  $<"
	@$(AVR_CXX) $(AVR_FLAGS) $(AVR_WARNINGS) $(AVR_INCLUDES) -MMD -MP -c $< -o $@

$(FIRMWARE_ELF): $(FIRMWARE_OBJECTS)
	@echo "  LINK $@"
	@$(AVR_CXX) $(AVR_FLAGS) $(AVR_WARNINGS) $(AVR_LINK) $^ -o $@

$(FIRMWARE_BUILD)/%.hex: $(FIRMWARE_BUILD)/%.elf
	@$(AVR_OBJCOPY) -O ihex -R .eeprom -R .fuse -R .lock $< $@

$(FIRMWARE_BUILD)/%.lst: $(FIRMWARE_BUILD)/%.elf
	@$(AVR_OBJDUMP) -d $< > $@

$(FIRMWARE_BUILD)/%.size: $(FIRMWARE_BUILD)/%.elf
	@$(AVR_SIZE) -A $< > $@

-include $(FIRMWARE_OBJECTS:.o=.d)
