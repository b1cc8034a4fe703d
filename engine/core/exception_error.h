// errorOf: an exception of the standard library or of another library as an Error, in plain words.
#pragma once

#include <exception>

#include "engine/core/result.h"

namespace rivulet {

// Whether memory ran out: std::bad_alloc, std::length_error, or what jsoncpp throws then.
bool isNoMemory(const std::exception& thrown);

// `thrown` is not null: std::current_exception() in a catch block. The Error is `failed`.
Error errorOf(const std::exception_ptr& thrown);

}  // namespace rivulet
