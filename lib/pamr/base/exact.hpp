// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <type_traits>

namespace pamr {

/// Whether `To` (an integer or `bool`) cannot hold what an argument of type `From` says: fractions, the digits of a
/// wider integer, in a `bool` all but true and false. Signs are not looked at, but for unsigned integers of the same
/// width as a `To` below 64 bits: sizes of arrays count as `std::int64_t`, and literals as any unsigned integer.
template <class From, class To>
concept Narrows = (std::same_as<To, bool> &&
                   ((std::is_arithmetic_v<From> && !std::same_as<From, bool>) || std::is_pointer_v<From>)) ||
                  (!std::same_as<To, bool> && std::floating_point<From>) ||
                  (!std::same_as<To, bool> && std::integral<From> &&
                   (sizeof(From) > sizeof(To) || (sizeof(From) == sizeof(To) && sizeof(To) < 8 &&
                                                  std::unsigned_integral<From> && std::signed_integral<To>)));

/// A parameter or an option of type `T` that C++ does not fill with a value cut to fit: `Exact<int> layers` takes no
/// 2.5, no 64-bit number, and `Exact<bool>` no pointer and no number. It is read as a `T`.
template <class T>
class Exact {
 public:
  template <class From>
  requires(std::convertible_to<const From&, T> && !Narrows<std::decay_t<From>, T>) constexpr Exact(const From& value)
      : value_(static_cast<T>(value)) {}

  constexpr operator T() const { return value_; }
  friend constexpr T format_as(Exact exact) { return exact.value_; }  // what fmt prints; version 9 converts by itself

 private:
  T value_;
};

}  // namespace pamr
