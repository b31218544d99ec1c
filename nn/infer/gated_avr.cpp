// A row of gated.h for the AVR, in assembly: 14 cycles a product, where the compiler takes twice as
// many. Does nothing on other machines.
//
//   r30:31 row   r26:27 x   r20 values left   r19:r25:r24 sum   r18, r22 factors   r21 zero
#ifdef __AVR__

// clang-format off
asm(R"(
  .section .text.screed_nn_row8,"ax",@progbits
  .global screed_nn_row8
  .type screed_nn_row8, @function
screed_nn_row8:
  movw r30, r24
  movw r26, r22
  clr r21
  clr r24
  clr r19
  lpm r25, Z+          ; 128 bias = (bias << 8) >> 1
  asr r25
  ror r24
  sbrc r25, 7
  com r19
1:
  lpm r18, Z+
  ld r22, X+
  muls r18, r22        ; the carry is the product's sign
  sbc r19, r21
  add r24, r0
  adc r25, r1
  adc r19, r21
  dec r20
  brne 1b
  clr r1
  mov r18, r25         ; fits 16 bits: the third byte is the sign of the second
  lsl r18
  sbc r18, r18
  cp r18, r19
  breq 2f
  ldi r24, 0xFF
  ldi r25, 0x7F
  sbrs r19, 7
  rjmp 2f
  com r24
  com r25
2:
  ret
  .size screed_nn_row8, . - screed_nn_row8
  .section .text
)");
// clang-format on

#endif
