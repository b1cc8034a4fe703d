// Errors as values: a Result<T> holds a T, or an error message with file, position and remedy.
#pragma once

#include <string>
#include <utility>
#include <variant>

#include "engine/core/abi.h"

namespace rivulet {

// As in core/assert.h, which is not included: hosts include this header and must not see the macro ASSERT.
[[noreturn]] void assertFailed(const char* condition, const char* remedy, const char* file, int line);

// The kind of an error, and the program's exit status: badInput = 2 (invalid file, key, value or argument), failed = 1 (a valid request
// could not be carried out).
enum class Fault { badInput, failed };

struct Error {
    std::string message;  // one sentence, no trailing newline
    Fault fault = Fault::badInput;
    bool memory = false;  // memory ran out: the same may succeed when there is some again
};

inline Error badInput(std::string message) { return {std::move(message), Fault::badInput}; }
inline Error failed(std::string message) { return {std::move(message), Fault::failed}; }
inline Error noMemory(std::string message) { return {std::move(message), Fault::failed, true}; }

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

// The result of a function that returns no value but may fail: `return ok();`.
struct Done {};
using Status = Result<Done>;
inline Status ok() { return Done{}; }

}  // namespace rivulet
