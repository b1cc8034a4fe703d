#include "engine/core/json_text.h"

#include <memory>
#include <sstream>

namespace rivulet {

std::string jsonText(const Json::Value& value, int digits, std::string_view indent) {
    Json::StreamWriterBuilder builder;
    builder["indentation"] = std::string(indent);
    builder["enableYAMLCompatibility"] = true;  // "key": value
    builder["precision"] = digits;
    std::ostringstream text;
    text.exceptions(std::ios::badbit);
    const std::unique_ptr<Json::StreamWriter> writer(builder.newStreamWriter());
    writer->write(value, &text);
    text << '\n';
    return text.str();
}

}  // namespace rivulet
