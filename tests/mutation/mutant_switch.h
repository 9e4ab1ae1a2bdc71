#pragma once
#include <algorithm>
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <type_traits>

#include <glm/glm.hpp>

/// Every mutant of the reference in one program: sites.py writes a copy of the sources in which an operator
/// such as `a < b` reads `a < Switch<17, '<', ...>{} < b`, which has the precedence and the association of
/// the original. `active` is the number of the one mutant that is on; 0: the program as it is.
namespace palpate::mutation {

inline int active = 0;

/// Leaves with this status when the mutant that is on would not have compiled.
inline constexpr int kNoProgram = 77;

template <class T = void>
[[noreturn]] void no_program() {
  std::_Exit(kNoProgram);
}

// The native engine's vectors (nearest_points.h) are arrays of std's, whose operators no argument leads to.
using Vector = std::array<double, 3>;
inline Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

enum class Op { kLess, kLessEqual, kGreater, kGreaterEqual, kEqual, kNotEqual, kPlus, kMinus };

template <Op op>
struct Apply {
  template <class A, class B>
  static constexpr bool possible() {
    if constexpr (op == Op::kLess) return requires(const A& a, const B& b) {
        a < b;
      };
    if constexpr (op == Op::kLessEqual) return requires(const A& a, const B& b) {
        a <= b;
      };
    if constexpr (op == Op::kGreater) return requires(const A& a, const B& b) {
        a > b;
      };
    if constexpr (op == Op::kGreaterEqual) return requires(const A& a, const B& b) {
        a >= b;
      };
    if constexpr (op == Op::kEqual) return requires(const A& a, const B& b) {
        a == b;
      };
    if constexpr (op == Op::kNotEqual) return requires(const A& a, const B& b) {
        a != b;
      };
    if constexpr (op == Op::kPlus) return requires(const A& a, const B& b) {
        a + b;
      };
    if constexpr (op == Op::kMinus) return requires(const A& a, const B& b) {
        a - b;
      };
  }
  template <class A, class B>
  static constexpr auto of(const A& a, const B& b) {
    if constexpr (op == Op::kLess) return a < b;
    if constexpr (op == Op::kLessEqual) return a <= b;
    if constexpr (op == Op::kGreater) return a > b;
    if constexpr (op == Op::kGreaterEqual) return a >= b;
    if constexpr (op == Op::kEqual) return a == b;
    if constexpr (op == Op::kNotEqual) return a != b;
    if constexpr (op == Op::kPlus) return a + b;
    if constexpr (op == Op::kMinus) return a - b;
  }
};

/// The left operand of `op`, on its way to the right one. Mutant `first` makes `op` to `one`, mutant first +
/// 1 to `other`.
template <class A, int first, Op op, Op one, Op other>
struct Left {
  const A& a;

  template <class B>
  constexpr auto with(const B& b) const {
    using Result = decltype(Apply<op>::of(a, b));
    if (!std::is_constant_evaluated()) {
      if (active == first) return changed<one, Result>(b);
      if (other != one && active == first + 1) return changed<other, Result>(b);
    }
    return Apply<op>::of(a, b);
  }
  template <Op change, class Result, class B>
  constexpr Result changed(const B& b) const {
    if constexpr (!Apply<change>::template possible<A, B>())
      no_program();
    else if constexpr (!std::is_convertible_v<decltype(Apply<change>::of(a, b)), Result>)
      no_program();
    else
      return static_cast<Result>(Apply<change>::of(a, b));
  }
};

template <int first, Op op, Op one, Op other = one>
struct Switch {};

#define PALPATE_SWITCH_OPERATOR(sign)                                                 \
  template <class A, int first, Op op, Op one, Op other>                              \
  constexpr auto operator sign(const A& a, Switch<first, op, one, other>) {           \
    return Left<A, first, op, one, other>{a};                                         \
  }                                                                                   \
  template <class A, int first, Op op, Op one, Op other, class B>                     \
  constexpr auto operator sign(const Left<A, first, op, one, other>& a, const B& b) { \
    return a.with(b);                                                                 \
  }
PALPATE_SWITCH_OPERATOR(<)
PALPATE_SWITCH_OPERATOR(<=)
PALPATE_SWITCH_OPERATOR(>)
PALPATE_SWITCH_OPERATOR(>=)
PALPATE_SWITCH_OPERATOR(==)
PALPATE_SWITCH_OPERATOR(!=)
PALPATE_SWITCH_OPERATOR(+)
PALPATE_SWITCH_OPERATOR(-)
#undef PALPATE_SWITCH_OPERATOR

/// `-x` and `!x` read `Negative<17>{} ->* x`, which binds as tightly.
template <int id>
struct Negative {
  template <class A>
  constexpr auto operator->*(const A& a) const {
    using Result = decltype(-a);
    return !std::is_constant_evaluated() && active == id ? static_cast<Result>(+a) : static_cast<Result>(-a);
  }
};
template <int id>
struct Not {
  template <class A>
  constexpr bool operator->*(const A& a) const {
    return !std::is_constant_evaluated() && active == id ? static_cast<bool>(a) : !static_cast<bool>(a);
  }
};

/// `x += y` reads `x += Added<17>{} = y`.
template <class B, int id, bool plus>
struct Change {
  const B& b;
};
template <int id, bool plus>
struct Added {
  template <class B>
  constexpr Change<B, id, plus> operator=(const B& b) const {
    return {b};
  }
};
template <class A, class B, int id, bool plus>
constexpr A& change(A& a, const Change<B, id, plus>& by) {
  bool changed = false;  // a const one would be worked out at compile time, where no mutant is on
  if (!std::is_constant_evaluated()) changed = active == id;
  if constexpr (requires {
                  a += by.b;
                  a -= by.b;
                }) {
    if (plus != changed)
      a += by.b;
    else
      a -= by.b;
  } else {  // text
    if (changed) no_program();
    a += by.b;
  }
  return a;
}
template <class A, class B, int id, bool plus>
constexpr A& operator+=(A& a, const Change<B, id, plus>& by) {
  return change(a, by);
}
template <class A, class B, int id, bool plus>
constexpr A& operator-=(A& a, const Change<B, id, plus>& by) {
  return change(a, by);
}
template <glm::length_t n, class T, glm::qualifier q, class B, int id, bool plus>
constexpr glm::vec<n, T, q>& operator+=(glm::vec<n, T, q>& a, const Change<B, id, plus>& by) {
  return change(a, by);
}
template <glm::length_t n, class T, glm::qualifier q, class B, int id, bool plus>
constexpr glm::vec<n, T, q>& operator-=(glm::vec<n, T, q>& a, const Change<B, id, plus>& by) {
  return change(a, by);
}

/// `a && b` reads `a && (And<17>{} | b)`: the mutant takes b for true; `a || b` reads `a || (Or<17>{} & b)`:
/// for false. (An operator that became the other one would evaluate b where it must not be.)
template <int id>
struct And {
  template <class B>
  constexpr bool operator|(const B& b) const {
    return (!std::is_constant_evaluated() && active == id) || static_cast<bool>(b);
  }
};
template <int id>
struct Or {
  template <class B>
  constexpr bool operator&(const B& b) const {
    return !(!std::is_constant_evaluated() && active == id) && static_cast<bool>(b);
  }
};

/// std::min(…) reads Extreme<17, true>::of(…).
template <int id, bool smallest>
struct Extreme {
  template <class... A>
  static constexpr auto of(const A&... a) {
    return smallest != (!std::is_constant_evaluated() && active == id) ? std::min(a...) : std::max(a...);
  }
  template <class A>
  static constexpr auto of(std::initializer_list<A> a) {
    return smallest != (!std::is_constant_evaluated() && active == id) ? std::min(a) : std::max(a);
  }
};
}  // namespace palpate::mutation
