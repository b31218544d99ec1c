; What runs before main(): the interrupt vectors and the stack pointer. The start-up code of the C
; library has 24 bytes of vectors behind the last one that is used, and an end of the program.
;
; An interrupt without a handler starts the program anew, as the C library's does. The linker
; script refuses a handler beyond LAST_VECTOR (firmware.mk).
#include <avr/io.h>

  .section .vectors, "ax", @progbits
  .global __vectors
__vectors:
  jmp __init

  .macro vector number
  .weak __vector_\number
  .set __vector_\number, __vectors
  jmp __vector_\number
  .endm

  .altmacro
  .set number, 1
  .rept LAST_VECTOR
  vector %number
  .set number, number + 1
  .endr

  .section .init0, "ax", @progbits
__init:

; .init3 and .init4 are those of libgcc: data and variables.
  .section .init2, "ax", @progbits
  clr r1
  out _SFR_IO_ADDR(SREG), r1
  ldi r28, lo8(RAMEND)
  ldi r29, hi8(RAMEND)
  out _SFR_IO_ADDR(SPH), r29
  out _SFR_IO_ADDR(SPL), r28

  .section .init9, "ax", @progbits
  jmp main
