/// A vector whose copies share its memory until one of them changes.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <utility>
#include <vector>

#include "abbe/base/paged.h"

namespace abbe {

/// Values that are many and seldom change: pixels. Reads are those of std::vector; what changes a
/// copy that others share, or that lies in a PageStore, gives it memory of its own first.
template <typename T>
class SharedValues {
 public:
  using value_type = T;
  using const_iterator = const T*;
  using iterator = const_iterator;

  SharedValues() = default;
  SharedValues(std::vector<T> values)
      : values_(std::make_shared<std::vector<T>>(std::move(values))) {}
  SharedValues(std::initializer_list<T> values) : SharedValues(std::vector<T>(values)) {}
  /// Moved into a store, where there is one. Errors: as PageStore::keep.
  SharedValues(std::vector<T> values, const std::shared_ptr<PageStore>& store) {
    if (store && !values.empty()) {
      pages_ = store->keep(values.data(), values.size() * sizeof(T));
    } else {
      *this = SharedValues(std::move(values));
    }
  }

  std::size_t size() const {
    return pages_ ? pages_->count / sizeof(T) : values_ ? values_->size() : 0;
  }
  bool empty() const { return size() == 0; }
  const T* data() const {
    return pages_ ? static_cast<const T*>(pages_->data) : values_ ? values_->data() : nullptr;
  }
  /// Where they lie, if not in memory.
  std::shared_ptr<PageStore> store() const { return pages_ ? pages_->store : nullptr; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size(); }
  const T& operator[](std::size_t i) const { return data()[i]; }

  void push_back(T value) { own().push_back(value); }
  void append(std::initializer_list<T> values) {
    std::vector<T>& to = own();
    to.insert(to.end(), values);
  }

 private:
  std::vector<T>& own() {
    if (pages_) {
      values_ = std::make_shared<std::vector<T>>(begin(), end());
      pages_.reset();
    } else if (!values_) {
      values_ = std::make_shared<std::vector<T>>();
    } else if (values_.use_count() > 1) {
      values_ = std::make_shared<std::vector<T>>(*values_);
    }
    return *values_;
  }

  std::shared_ptr<std::vector<T>> values_;  // One of these two, or none.
  std::shared_ptr<const PagedBytes> pages_;
};

}  // namespace abbe
