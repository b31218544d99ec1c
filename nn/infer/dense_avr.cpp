// The layer of dense.h for the AVR, in assembly: the compiler would call a helper of 50 cycles for
// each product. Does nothing on other machines.
//
// A multiply-accumulate is 20 cycles of arithmetic (four 8x8 products, all unsigned thanks to the
// offsets of dense.h) and 6 to load the weight from flash.
//
// Registers in the row loop:
//   r2..r15    up to seven inputs + 2^15 (low, high)
//   r16..r19   sum               r20   weight's byte, scratch      r21   zero
//   r22        rows left         r23   mode | 0x80 when the sum of inputs is odd
//   r24, r25   sum of inputs / 2                r26, r27  out      r30, r31  parameters
//   r28, r29   scratch of tanh; inputs when they are streamed
#ifdef __AVR__

// clang-format off
asm(R"(
; sum += weight * input; the weight comes from flash
.macro screed_nn_mac low, high
  lpm r20, Z+
  mul \low, r20
  add r16, r0
  adc r17, r1
  adc r18, r21
  adc r19, r21
  mul \high, r20
  add r17, r0
  adc r18, r1
  adc r19, r21
  lpm r20, Z+
  mul \low, r20
  add r17, r0
  adc r18, r1
  adc r19, r21
  mul \high, r20
  add r18, r0
  adc r19, r1
.endm

; an input becomes unsigned and counts in the sum of inputs (r24, r25, r20)
.macro screed_nn_count low, high
  eor \high, r21
  add r24, \low
  adc r25, \high
  adc r20, r17
.endm

; arguments: r24:25 in, r22:23 out, r20:21 parameters, r18 outputs, r16 mode; Y is saved by the caller of this macro
.macro screed_nn_begin
  movw r28, r24
  movw r26, r22
  movw r30, r20
  mov r22, r18
  mov r23, r16
  ldi r21, 0x80
  clr r17
  clr r20
  clr r24
  clr r25
.endm

; r20:r25:r24 = sum of inputs -> half of it in r24, r25, its parity in bit 7 of r23; then r21 = 0
.macro screed_nn_halve
  clr r21
  lsr r20
  ror r25
  ror r24
  brcc 1f
  ori r23, 0x80
1:
.endm

; sum = row's constant - 2^15 * sum of inputs
.macro screed_nn_row
  lpm r16, Z+
  lpm r17, Z+
  lpm r18, Z+
  lpm r19, Z+
  mov r20, r23
  andi r20, 0x80
  sub r17, r20
  sbc r18, r24
  sbc r19, r25
.endm

; z = the sum's upper word after a shift to the left that stops at the ends; y = tanh(z), or z in a linear layer, stored
; uses r20, r28, r29 and, for the parameters' address, r16 and r17
.macro screed_nn_finish with_tanh
  mov r20, r23
  andi r20, 0x0F
  breq 3f
1:
  lsl r16
  rol r17
  rol r18
  rol r19
  brvs 2f
  dec r20
  brne 1b
  rjmp 3f
2:                     ; overflow: the sign has just turned
  ldi r18, 0xFF
  ldi r19, 0x7F
  brmi 3f
  ldi r18, 0x00
  ldi r19, 0x80
3:
.if \with_tanh
  sbrc r23, 6
  rjmp 5f
  bst r19, 7
  brtc 4f
  com r18
  com r19
4:
  movw r16, r30
  mov r30, r19
  clr r31
  lsl r30
  subi r30, lo8(-(screed_nn_tanh_table))
  sbci r31, hi8(-(screed_nn_tanh_table))
  mov r20, r18
  lpm r18, Z+
  lpm r19, Z+
  lpm r28, Z+
  lpm r29, Z
  sub r28, r18
  sbc r29, r19
  mul r28, r20
  add r18, r1
  adc r19, r21
  mul r29, r20
  add r18, r0
  adc r19, r1
  movw r30, r16
  brtc 5f
  com r18
  com r19
5:
.endif
  st X+, r18
  st X+, r19
.endm

.macro screed_nn_push first, last
  .set screed_nn_r, \first
  .rept \last - \first + 1
    push screed_nn_r
    .set screed_nn_r, screed_nn_r + 1
  .endr
.endm
.macro screed_nn_pop first, last
  .set screed_nn_r, \last
  .rept \last - \first + 1
    pop screed_nn_r
    .set screed_nn_r, screed_nn_r - 1
  .endr
.endm

; a layer whose inputs stay in registers
.macro screed_nn_dense_resident name, inputs
  .section .text.\name,"ax",@progbits
  .global \name
  .type \name, @function
\name:
  screed_nn_push 2, 2 * \inputs + 1
  push r16
  push r17
  push r28
  push r29
  screed_nn_begin
  .set screed_nn_r, 2
  .rept \inputs
    ld screed_nn_r, Y+
    ld screed_nn_r + 1, Y+
    screed_nn_count screed_nn_r, screed_nn_r + 1
    .set screed_nn_r, screed_nn_r + 2
  .endr
  screed_nn_halve
6:
  screed_nn_row
  .set screed_nn_r, 2
  .rept \inputs
    screed_nn_mac screed_nn_r, screed_nn_r + 1
    .set screed_nn_r, screed_nn_r + 2
  .endr
  screed_nn_finish 1
  dec r22
  breq 7f
  rjmp 6b
7:
  clr r1
  pop r29
  pop r28
  pop r17
  pop r16
  screed_nn_pop 2, 2 * \inputs + 1
  ret
  .size \name, . - \name
.endm

screed_nn_dense_resident screed_nn_dense4, 4
screed_nn_dense_resident screed_nn_dense7, 7

; a layer whose inputs are loaded for each node; r14 holds their number, r12:13 their address, r2, r3 the input, r4 0x80
.macro screed_nn_dense_streamed name, with_tanh
  .section .text.\name,"ax",@progbits
  .global \name
  .type \name, @function
\name:
  screed_nn_push 2, 5
  push r12
  push r13
  push r16
  push r17
  push r28
  push r29
  movw r12, r24
  screed_nn_begin
  mov r4, r21
  mov r5, r14
1:
  ld r2, Y+
  ld r3, Y+
  screed_nn_count r2, r3
  dec r5
  brne 1b
  screed_nn_halve
6:
  movw r28, r12
  mov r5, r14
  screed_nn_row
8:
  ld r2, Y+
  ld r3, Y+
  eor r3, r4
  screed_nn_mac r2, r3
  dec r5
  brne 8b
  screed_nn_finish \with_tanh
  dec r22
  breq 7f
  rjmp 6b
7:
  clr r1
  pop r29
  pop r28
  pop r17
  pop r16
  pop r13
  pop r12
  screed_nn_pop 2, 5
  ret
  .size \name, . - \name
.endm

screed_nn_dense_streamed screed_nn_dense, 1
; without the table of tanh
screed_nn_dense_streamed screed_nn_dense_linear, 0

  .section .text
)");
// clang-format on

#endif
