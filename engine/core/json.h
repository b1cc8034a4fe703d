// Reads Params from JSON and writes them. Reading is strict: an unknown key, a wrong type or a value out of range is an Error with file,
// line, column, JSON path and the nearest valid name. Time and memory are bounded: files above 64 MiB, nesting above 64 levels and more
// than 262144 values are refused. No exception is thrown, and numbers do not depend on the locale.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "engine/core/params.h"
#include "engine/core/result.h"

namespace rivulet {

using VisitFn = std::function<void(ParamVisitor&)>;  // [&](ParamVisitor& v) { scene.visit(v); }

// Reads `text` (named `file` in errors) into the struct that `visit` visits. After an Error the struct may be partly changed: read into a
// copy.
Status readJson(std::string_view text, std::string_view file, const VisitFn& visit);
Status readJsonFile(const std::string& path, const VisitFn& visit);

// Writes all values, or only those that differ from `defaults` (a visit of a default-constructed struct; null: all values). Ends in a
// newline. Numbers read back exactly. JSON has no NaN and infinity: they are written as null, which readJson refuses with the path.
std::string writeJson(const VisitFn& visit, const VisitFn* defaults = nullptr);

// Sets one value: "path.to.param=value", lists by index: "colliders.0.resolution=64"; an index one past the end appends an item. The
// checks are those of readJson; a vector is 1,2,3 or [1,2,3]. After an Error the struct is unchanged, except that an appended item stays.
Status setParam(std::string_view assignment, const VisitFn& visit);

// A Markdown table of every path, unit, range, default and doc: the content of docs/parameters.md.
std::string describeParams(const VisitFn& visit);

}  // namespace rivulet
