// What the mutated copy of a source calls: every mutant of a file is compiled into it at once, and
// the environment says at the start of the program which one is alive (MUTANT=number; none: 0).
//
// An operator of two operands is mutated without knowing where its operands end: `a + b` becomes
// `a + Plus{7} + b`, of the same precedence, so that the compiler finds the operands. C++14,
// because firmware is.
//
// Compiled with MUTANTS_REACH, no mutant is alive and every one that is passed is noted instead.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <type_traits>

namespace mutants {

extern int alive;
extern unsigned char* reached;  // a byte a mutant of all files

// Of each source its own: what the linker took for the same would count for another source.
namespace {

inline bool on(int id) {
#ifdef MUTANTS_REACH
  if (id > 0) reached[id] = 1;
  return false;
#else
  return id == alive;
#endif
}

template <class A, class Operator>
struct Left {
  const A& value;
  int id;
};

// What the original and its mutant make, in one type: their own, or for Eigen's expressions the
// matrix that both are.
template <class A, class B, class = void>
struct Common {};
template <class A>
struct Common<A, A, void> {
  using type = A;
};
template <class A, class B>
struct Common<A, B,
              typename std::enable_if<
                  !std::is_same<A, B>::value &&
                  std::is_same<typename A::PlainObject, typename B::PlainObject>::value>::type> {
  using type = typename A::PlainObject;
};

// An operator with one mutant; with two, for comparisons: boundary and opposite.
#define MUTANTS_OPERATOR(Name, op, other, result)                                            \
  struct Name {                                                                              \
    int id;                                                                                  \
  };                                                                                         \
  template <class A>                                                                         \
  Left<A, Name> operator op(const A& a, Name name) {                                         \
    return {a, name.id};                                                                     \
  }                                                                                          \
  template <class A, class B>                                                                \
  auto operator op(const Left<A, Name>& a, const B& b)                                       \
      ->typename Common<decltype(a.value op b), decltype(a.value other b)>::type {           \
    using Result = typename Common<decltype(a.value op b), decltype(a.value other b)>::type; \
    result                                                                                   \
  }
#define MUTANTS_ARITHMETIC(Name, op, other)                                       \
  MUTANTS_OPERATOR(Name, op, other, if (on(a.id)) return Result(a.value other b); \
                   return Result(a.value op b);)
#define MUTANTS_COMPARISON(Name, op, boundary, opposite)                                \
  MUTANTS_OPERATOR(Name, op, boundary, if (on(a.id)) return Result(a.value boundary b); \
                   if (on(a.id + 1)) return Result(a.value opposite b);                 \
                   return Result(a.value op b);)
MUTANTS_ARITHMETIC(Plus, +, -)
MUTANTS_ARITHMETIC(Minus, -, +)
MUTANTS_ARITHMETIC(Times, *, /)
MUTANTS_ARITHMETIC(Over, /, *)
MUTANTS_ARITHMETIC(Modulo, %, *)
MUTANTS_ARITHMETIC(BitAnd, &, |)
MUTANTS_ARITHMETIC(BitOr, |, &)
MUTANTS_ARITHMETIC(BitXor, ^, |)
MUTANTS_ARITHMETIC(ShiftLeft, <<, >>)
MUTANTS_ARITHMETIC(ShiftRight, >>, <<)
MUTANTS_COMPARISON(Less, <, <=, >=)
MUTANTS_COMPARISON(LessEqual, <=, <, >)
MUTANTS_COMPARISON(Greater, >, >=, <=)
MUTANTS_COMPARISON(GreaterEqual, >=, >, <)
MUTANTS_ARITHMETIC(Equal, ==, !=)
MUTANTS_ARITHMETIC(NotEqual, !=, ==)

/// Two mutants of a condition: the opposite, and always true; -1: there is none.
inline bool condition(int opposite, int always, bool value) {
  const bool negated = on(opposite);
  return on(always) || value != negated;
}
inline bool flip(int id, bool value) {
  return value != on(id);
}

#define MUTANTS_ASSIGNMENT(name, op, other) \
  template <class A, class B>               \
  A& name(int id, A& a, const B& b) {       \
    if (on(id)) {                           \
      a other b;                            \
    } else {                                \
      a op b;                               \
    }                                       \
    return a;                               \
  }
MUTANTS_ASSIGNMENT(add, +=, -=)
MUTANTS_ASSIGNMENT(subtract, -=, +=)
MUTANTS_ASSIGNMENT(multiply, *=, /=)
MUTANTS_ASSIGNMENT(divide, /=, *=)
MUTANTS_ASSIGNMENT(set_bits, |=, &=)
MUTANTS_ASSIGNMENT(keep_bits, &=, |=)

template <class A>
A& increment(int id, A& a) {
  return on(id) ? --a : ++a;
}
template <class A>
A& decrement(int id, A& a) {
  return on(id) ? ++a : --a;
}
template <class A>
A post_increment(int id, A& a) {
  return on(id) ? a-- : a++;
}
template <class A>
A post_decrement(int id, A& a) {
  return on(id) ? a++ : a--;
}

template <class A>
auto negative(int id, const A& a) -> typename Common<decltype(-a), decltype(+a)>::type {
  return on(id) ? +a : -a;
}
/// Eigen has no sign +.
template <class A>
auto negative(int id, const A& a) -> typename A::PlainObject {
  if (on(id)) return typename A::PlainObject(a);
  return typename A::PlainObject(-a);
}

struct Min {
  int id;
  template <class A>
  A of(const A& a, const A& b) const {
    return on(id) ? std::max(a, b) : std::min(a, b);
  }
  template <class A>
  A of(std::initializer_list<A> list) const {
    return on(id) ? std::max(list) : std::min(list);
  }
};
struct Max {
  int id;
  template <class A>
  A of(const A& a, const A& b) const {
    return on(id) ? std::min(a, b) : std::max(a, b);
  }
  template <class A>
  A of(std::initializer_list<A> list) const {
    return on(id) ? std::min(list) : std::max(list);
  }
};

}  // namespace
}  // namespace mutants
