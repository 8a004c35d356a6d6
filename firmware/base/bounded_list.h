#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace sidestep {

/// A list of at most `capacity` elements, stored in place, without heap. The unused part of the storage is not
/// initialised, because a control cycle constructs many of these lists and fills few of their places.
template <typename T, int capacity>
class BoundedList {
  static_assert(std::is_trivially_destructible_v<T>);

 public:
  BoundedList() = default;
  BoundedList(const BoundedList& other) { *this = other; }
  BoundedList& operator=(const BoundedList& other) {
    if (this == &other) return *this;
    size_ = other.size_;
    std::uninitialized_copy(other.begin(), other.end(), data());
    return *this;
  }

  int size() const { return size_; }
  bool is_full() const { return size_ == capacity; }
  /// Precondition: the list is not full. The capacity is not checked.
  void add(const T& element) { std::uninitialized_copy_n(&element, 1, data() + size_++); }
  /// Adds T{parts...}; same precondition as add().
  template <typename... Parts>
  void emplace(const Parts&... parts) {
    ::new (static_cast<void*>(data() + size_++)) T{parts...};
  }
  /// Removes element i; the last element takes its place, so the order changes.
  void remove(int i) { (*this)[i] = (*this)[--size_]; }
  void clear() { size_ = 0; }

  T& operator[](int i) { return data()[i]; }
  const T& operator[](int i) const { return data()[i]; }
  T* begin() { return data(); }
  T* end() { return data() + size_; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size_; }

 private:
  T* data() { return std::launder(reinterpret_cast<T*>(storage_)); }
  const T* data() const { return std::launder(reinterpret_cast<const T*>(storage_)); }

  int size_ = 0;
  alignas(T) std::byte storage_[sizeof(T[capacity])];
};

}  // namespace sidestep
