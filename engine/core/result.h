// Errors as values: a Result<T> holds a T or one plain sentence that names file, place and remedy.
#pragma once

#include <string>
#include <utility>
#include <variant>

namespace rivulet {

// As core/assert.h, whose macro would be a host's, too.
[[noreturn]] void assertFailed(const char* condition, const char* remedy, const char* file, int line);

// What the program's exit code says about an error: badInput = 2 (what was asked makes no sense), failed = 1 (it could not be carried out).
enum class Fault { badInput, failed };

struct Error {
    std::string message;  // one sentence, no trailing newline
    Fault fault = Fault::badInput;
};

inline Error badInput(std::string message) { return {std::move(message), Fault::badInput}; }
inline Error failed(std::string message) { return {std::move(message), Fault::failed}; }

template <class T>
class [[nodiscard]] Result {
  public:
    Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor): a function returns its T or its Error
    Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)
    explicit operator bool() const { return state_.index() == 0; }
    T& value() {
        if (state_.index() != 0) assertFailed("a Result has a value", "test a Result before reading its value", __FILE__, __LINE__);
        return std::get<0>(state_);
    }
    const T& value() const {
        if (state_.index() != 0) assertFailed("a Result has a value", "test a Result before reading its value", __FILE__, __LINE__);
        return std::get<0>(state_);
    }
    const Error& error() const {
        if (state_.index() != 1) assertFailed("a Result has an error", "a Result that succeeded has no error", __FILE__, __LINE__);
        return std::get<1>(state_);
    }
    T& operator*() { return value(); }
    const T& operator*() const { return value(); }
    T* operator->() { return &value(); }
    const T* operator->() const { return &value(); }

  private:
    std::variant<T, Error> state_;
};

// The result of work that returns nothing but may fail: `return ok();`.
struct Done {};
using Status = Result<Done>;
inline Status ok() { return Done{}; }

}  // namespace rivulet
