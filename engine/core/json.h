// Params from and to JSON, strictly: an unknown key, a wrong type or a value out of range is an Error with file, line, column,
// JSON path and the nearest valid name. Bounded in time and memory: files above 64 MiB, nesting above 64 and more than 262144 values
// are refused. No exception leaves, and no locale changes how a number reads.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "engine/core/params.h"
#include "engine/core/result.h"

namespace rivulet {

using VisitFn = std::function<void(ParamVisitor&)>;  // [&](ParamVisitor& v) { scene.visit(v); }

// Reads `text` (named `file` in errors) into the struct behind `visit`. On an Error the struct may be partly changed: read into a copy.
Status readJson(std::string_view text, std::string_view file, const VisitFn& visit);
Status readJsonFile(const std::string& path, const VisitFn& visit);

// Everything, or only what differs from `defaults` (a visit over a default-constructed struct; null = everything). Ends in a newline.
// Numbers read back exactly. NaN and infinity are no JSON: they are written as null, which readJson refuses by name.
std::string writeJson(const VisitFn& visit, const VisitFn* defaults = nullptr);

// "path.to.param=value", lists by index: "colliders.0.resolution=64"; an index one past the end appends an item. Checked as JSON is;
// a vector is 1,2,3 or [1,2,3]. On an Error the struct is as it was, but for an item that was appended.
Status setParam(std::string_view assignment, const VisitFn& visit);

// The generated reference: a markdown table of every path, unit, range, default and doc. What docs/parameters.md holds.
std::string describeParams(const VisitFn& visit);

}  // namespace rivulet
