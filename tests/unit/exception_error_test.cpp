// What is thrown, as a sentence.
#include "engine/core/exception_error.h"

#include <gtest/gtest.h>
#include <json/json.h>

#include <new>
#include <stdexcept>

namespace rivulet::exception_error_test {
namespace {

template <class Thrown>
std::string sentenceOf(const Thrown& thrown) {
    return errorOf(std::make_exception_ptr(thrown)).message;
}

TEST(ExceptionError, MemoryThatRanOutHasOneSentenceWhateverIsThrown) {
    const std::string sentence = sentenceOf(std::bad_alloc());
    EXPECT_TRUE(sentence.starts_with("out of memory")) << sentence;
    EXPECT_EQ(sentenceOf(std::length_error("vector::_M_default_append")), sentence);
    EXPECT_EQ(sentenceOf(Json::RuntimeError("in Json::Value::duplicateStringValue(): Failed to allocate string value buffer")), sentence);
    EXPECT_NE(sentenceOf(std::runtime_error("no")), sentence);
}

}  // namespace
}  // namespace rivulet::exception_error_test
