#include "engine/core/exception_error.h"

#include <fmt/format.h>
#include <json/json.h>

#include <filesystem>
#include <new>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "engine/core/descriptor.h"

namespace rivulet {

namespace {

const char* const kNoMemory = "out of memory; use fewer particles or coarser voxels";

std::string wordsOf(const std::error_code& code) {
    const bool known = code.category() == std::generic_category() || code.category() == std::system_category();
    return known ? reasonOf(code.value()) : code.message();
}

}  // namespace

bool isNoMemory(const std::exception& thrown) {
    if (dynamic_cast<const std::bad_alloc*>(&thrown) != nullptr) return true;
    if (dynamic_cast<const std::length_error*>(&thrown) != nullptr) return true;  // a container of more than the address space
    return dynamic_cast<const Json::RuntimeError*>(&thrown) != nullptr &&
           std::string_view(thrown.what()).find("Failed to allocate") != std::string_view::npos;
}

Error errorOf(const std::exception_ptr& thrown) {
    try {
        std::rethrow_exception(thrown);
    } catch (const std::filesystem::filesystem_error& error) {
        return failed(
            fmt::format("{} cannot be used: {}", error.path1().empty() ? "a file" : error.path1().string(), wordsOf(error.code())));
    } catch (const std::system_error& error) {
        return failed(fmt::format("the system refused a request: {}", wordsOf(error.code())));
    } catch (const std::exception& error) {
        if (isNoMemory(error)) return failed(kNoMemory);
        return failed(fmt::format("an unexpected fault occurred: {}", error.what()));
    } catch (...) {
        return failed("an unexpected fault occurred");
    }
}

}  // namespace rivulet
