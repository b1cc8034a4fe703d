// Sampling: McKay, Beckman and Conover 1979 (Latin hypercube).
#include "demos/rivulet/sweep.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <set>

#include "demos/rivulet/cli.h"
#include "demos/rivulet/run_options.h"
#include "engine/core/input_file.h"
#include "engine/core/json_parse.h"
#include "engine/core/number.h"
#include "engine/core/param_list.h"
#include "engine/core/table.h"
#include "fluid/scene/scene_inputs.h"

namespace rivulet {

namespace {

namespace fs = std::filesystem;

constexpr const char* kBrace = "{{";  // in a command: {, which is not the beginning of a name
constexpr const char* kTaskFolder = "{task}";
constexpr const char* kGrid = "grid";
constexpr const char* kHypercube = "latin hypercube";

// Whether `word` begins an option: "--out", "--out=DIR".
bool isOption(const std::string& word, std::string_view name) {
    return word.starts_with(name) && (word.size() == name.size() || word[name.size()] == '=');
}

bool hasOption(const std::vector<std::string>& words, std::string_view name) {
    return std::any_of(words.begin(), words.end(), [name](const std::string& word) { return isOption(word, name); });
}

// A generator of random bits that gives the same sequence on every platform: SplitMix64 (Steele, Lea and Flood 2014).
class SweepRandom {
  public:
    explicit SweepRandom(uint64_t seed) : state_(seed) {}
    uint64_t bits() {
        state_ += 0x9E3779B97F4A7C15U;
        uint64_t z = state_;
        z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
        z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
        return z ^ (z >> 31U);
    }
    double share() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }  // 0..1, without 1
    size_t below(size_t n) { return static_cast<size_t>(share() * static_cast<double>(n)); }

  private:
    uint64_t state_;
};

// The numbers of a sweep have 9 significant digits, which tell all floats apart: a last bit that differs between platforms does not show.
std::string sweepNumber(double x) { return fmt::format("{:.9g}", x); }

// "emitters[0].speed" -> "emitters[].speed"
std::string withoutIndices(const std::string& path) {
    std::string plain;
    for (const char c : path)
        if (!plain.ends_with('[') || c < '0' || c > '9') plain += c;
    return plain;
}

// Whether `name` is the path of a value that scenes have. Their name and doc change no result: a sweep may use these words otherwise.
bool isOfScenes(const std::string& name) {
    static const std::set<std::string> paths = [] {
        SceneFile scene;
        std::set<std::string> all;
        for (const ParamEntry& entry : listParams([&scene](ParamVisitor& v) { scene.visit(v); }))
            if (entry.kind == ParamEntry::Kind::value && entry.path != "name" && entry.path != "doc")
                all.insert(withoutIndices(entry.path));
        return all;
    }();
    return paths.contains(withoutIndices(name));
}

// The values of a parameter before tasks are made of them: a list, or a range.
struct SweepValues {
    std::vector<std::string> listed;  // empty: a range
    double from = 0, to = 0;
    bool logarithmic = false;

    double at(double share) const {
        if (!logarithmic) return from + (to - from) * share;
        return from * std::pow(to / from, share);
    }
};

class SweepReader {
  public:
    SweepReader(std::string_view text, const std::string& file) : text_(text), file_(file) {}

    Result<Sweep> read() {
        const Result<Json::Value> root = parseJson(text_, file_);
        if (!root) return root.error();
        if (!root->isObject()) return wrong(*root, "a sweep is an object: {\"command\": \"run SCENE ...\", \"parameters\": {...}}");
        if (Status known = checkKeys(*root, {"doc", "command", "commands", "parameters", "sampling", "samples", "seed"}, ""); !known)
            return known.error();
        sweep_.file = file_;
        sweep_.folder = fs::path(file_).parent_path().string();
        if (Status done = readCommands(*root); !done) return done.error();
        if (Status done = readSampling(*root); !done) return done.error();
        if (Status done = readParameters(*root); !done) return done.error();
        if (Status done = checkBraces(); !done) return done.error();
        return std::move(sweep_);
    }

  private:
    std::string placeAt(const Json::Value& value) const {
        return file_ + placeOf(text_, static_cast<size_t>(std::max<ptrdiff_t>(value.getOffsetStart(), 0)));
    }
    Error wrong(const Json::Value& value, const std::string& why) const { return badInput(fmt::format("{}: {}", placeAt(value), why)); }
    std::string literal(const Json::Value& value) const {
        return std::string(text_.substr(static_cast<size_t>(value.getOffsetStart()),
                                        static_cast<size_t>(value.getOffsetLimit() - value.getOffsetStart())));
    }

    Status checkKeys(const Json::Value& object, const std::vector<std::string>& known, const std::string& of) const {
        for (const std::string& key : object.getMemberNames()) {
            if (std::find(known.begin(), known.end(), key) != known.end()) continue;
            const std::string near = nearestName(key, known);
            return wrong(object[key], fmt::format("`{}` is not a key of {}; {}", key, of.empty() ? "a sweep" : of,
                                                  near.empty() ? fmt::format("its keys are {}", fmt::join(known, ", "))
                                                               : fmt::format("did you mean `{}`?", near)));
        }
        return ok();
    }

    Result<double> number(const Json::Value& value, const std::string& name) const {
        const std::string digits = literal(value);
        double x = 0;
        if (!value.isNumeric() || !parseNumber(digits, x) || !std::isfinite(x))
            return wrong(value, fmt::format("{} must be a number, but is {}", name, digits.substr(0, 60)));
        return x;
    }
    Result<size_t> count(const Json::Value& value, const std::string& name, size_t least) const {
        const Result<double> x = number(value, name);
        if (!x) return x.error();
        if (!(*x >= static_cast<double>(least) && *x <= static_cast<double>(kMostTasks)) || *x != std::floor(*x))
            return wrong(value, fmt::format("{} must be a whole number from {} to {}, but is {}", name, least, kMostTasks, literal(value)));
        return static_cast<size_t>(*x);
    }

    Result<std::vector<std::string>> split(const Json::Value& value) const {
        std::vector<std::string> words;
        std::string word;
        bool within = false;
        char quote = '\0';
        for (const char c : value.asString()) {
            if (quote != '\0' ? c == quote : c == '"' || c == '\'') {
                quote = quote == '\0' ? c : '\0';
                within = true;
            } else if (quote == '\0' && (c == ' ' || c == '\t' || c == '\n')) {
                if (within) words.push_back(std::move(word));
                word.clear();
                within = false;
            } else {
                word += c;
                within = true;
            }
        }
        if (quote != '\0') return wrong(value, fmt::format("the command has one {} without its partner", quote));
        if (within) words.push_back(std::move(word));
        if (words.empty()) return wrong(value, "the command is empty; write for example \"run dam_break --no-render\"");
        if (words.front() == "rivulet") words.erase(words.begin());
        if (words.empty() || words.front().starts_with('-'))
            return wrong(value, "the command has no verb; write for example \"run dam_break\"");
        return words;
    }

    // The default outputs of `run` and `export` in a sweep are in the task's folder. A replay has no statistics.
    static void addOutputs(std::vector<std::string>& words) {
        const bool runs = words.front() == "run";
        if ((runs || words.front() == "export") && !hasOption(words, "--out")) words.insert(words.end(), {"--out", kTaskFolder});
        if (runs && !hasOption(words, "--stats") && !hasOption(words, "--replay"))
            words.insert(words.end(), {"--stats", fmt::format("{}/stats.json", kTaskFolder)});
    }

    Status readCommands(const Json::Value& root) {
        const bool one = root.isMember("command"), several = root.isMember("commands");
        if (one == several)
            return wrong(root, one ? "`command` and `commands` exclude each other; leave one of them out"
                                   : "`command` is missing; add for example \"command\": \"run dam_break --no-render\"");
        const Json::Value& value = root[one ? "command" : "commands"];
        if (one ? !value.isString() : !value.isArray() || value.empty())
            return wrong(value, one ? "`command` must be a text" : "`commands` must be a list of texts, at least one");
        for (Json::ArrayIndex k = 0; k < (one ? 1 : value.size()); ++k) {
            const Json::Value& text = one ? value : value[k];
            if (!text.isString()) return wrong(text, "a command must be a text");
            Result<std::vector<std::string>> words = split(text);
            if (!words) return words.error();
            addOutputs(*words);
            sweep_.commands.push_back({std::move(*words), placeAt(text)});
        }
        return ok();
    }

    Status readSampling(const Json::Value& root) {
        if (root.isMember("sampling")) {
            const Json::Value& value = root["sampling"];
            if (!value.isString() || (value.asString() != kGrid && value.asString() != kHypercube))
                return wrong(value, fmt::format("`sampling` must be \"{}\" or \"{}\", but is {}", kGrid, kHypercube, literal(value)));
            hypercube_ = value.asString() == kHypercube;
        }
        for (const char* key : {"samples", "seed"})
            if (!hypercube_ && root.isMember(key))
                return wrong(root[key],
                             fmt::format("`{}` belongs to a hypercube; add \"sampling\": \"{}\" or leave it out", key, kHypercube));
        if (!hypercube_) return ok();
        if (!root.isMember("samples"))
            return wrong(root["sampling"], fmt::format("a {} needs the number of its tasks; add for example \"samples\": 100", kHypercube));
        const Result<size_t> samples = count(root["samples"], "`samples`", 1);
        if (!samples) return samples.error();
        samples_ = *samples;
        if (!root.isMember("seed")) return ok();
        const Result<double> seed = number(root["seed"], "`seed`");
        if (!seed) return seed.error();
        if (*seed < 0 || *seed > 9007199254740992.0 || *seed != std::floor(*seed))
            return wrong(root["seed"], fmt::format("`seed` must be a whole number from 0 to 2^53, but is {}", literal(root["seed"])));
        seed_ = static_cast<uint64_t>(*seed);
        return ok();
    }

    Result<SweepValues> readValues(const std::string& name, const Json::Value& value) const {
        SweepValues values;
        if (value.isArray()) {
            if (value.empty()) return wrong(value, fmt::format("{} has no values; list at least one", name));
            values.listed.reserve(value.size());
            for (const Json::Value& each : value) {
                if (!each.isString() && !each.isBool() && !each.isNumeric())
                    return wrong(
                        each, fmt::format("a value of {} must be a number, a text or true or false; a vector is a text, \"1,2,3\"", name));
                const std::string text = each.isString() ? each.asString() : literal(each);
                if (std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }))
                    return wrong(each, fmt::format("a value of {} has a line break or another control character; leave it out", name));
                values.listed.push_back(text);
            }
            return values;
        }
        if (!value.isObject())
            return wrong(value, fmt::format("{} must be a list of values, or a range: {{\"from\": 1, \"to\": 10, \"count\": 4}}", name));
        return readRange(name, value);
    }

    Result<SweepValues> readRange(const std::string& name, const Json::Value& range) const {
        if (Status known = checkKeys(range, {"from", "to", "count", "scale", "pieces"}, fmt::format("the range of {}", name)); !known)
            return known.error();
        SweepValues values;
        for (const auto& [key, end] : {std::pair("from", &values.from), std::pair("to", &values.to)}) {
            if (!range.isMember(key)) return wrong(range, fmt::format("the range of {} has no `{}`; add it", name, key));
            const Result<double> x = number(range[key], fmt::format("`{}` of {}", key, name));
            if (!x) return x.error();
            *end = *x;
        }
        if (!(values.from < values.to))
            return wrong(range, fmt::format("the range of {} is empty: it is from {} to {}; `from` must be less than `to`", name,
                                            literal(range["from"]), literal(range["to"])));
        if (range.isMember("scale")) {
            const Json::Value& scale = range["scale"];
            if (!scale.isString() || (scale.asString() != "log" && scale.asString() != "linear"))
                return wrong(scale, fmt::format("`scale` of {} must be \"linear\" or \"log\", but is {}", name, literal(scale)));
            values.logarithmic = scale.asString() == "log";
        }
        if (values.logarithmic && values.from <= 0)
            return wrong(range["from"],
                         fmt::format("a logarithmic range must be above 0, but that of {} is from {}; raise `from` or use the "
                                     "scale \"linear\"",
                                     name, literal(range["from"])));
        if (range.isMember("pieces")) return readPieces(name, range, values);
        if (hypercube_ && range.isMember("count"))
            return wrong(range["count"], fmt::format("a hypercube takes `samples` values of {}; leave `count` out", name));
        if (hypercube_) return values;
        if (!range.isMember("count"))
            return wrong(range, fmt::format("the range of {} needs the number of its values: add \"count\": 5", name));
        const Result<size_t> steps = count(range["count"], fmt::format("`count` of {}", name), 2);
        if (!steps) return steps.error();
        values.listed.reserve(*steps);
        for (size_t k = 0; k < *steps; ++k)
            values.listed.push_back(sweepNumber(values.at(static_cast<double>(k) / static_cast<double>(*steps - 1))));
        values.listed.back() = sweepNumber(values.to);
        return values;
    }

    // "0:30", "30:60": parts of a range of whole numbers, each from its first to before its last.
    Result<SweepValues> readPieces(const std::string& name, const Json::Value& range, SweepValues values) const {
        for (const char* key : {"count", "scale"})
            if (range.isMember(key))
                return wrong(range[key], fmt::format("`{}` and `pieces` of {} exclude each other; leave one of them out", key, name));
        for (const char* key : {"from", "to"}) {
            const Result<double> x = number(range[key], key);
            if (*x != std::floor(*x) || std::abs(*x) > 1e9)
                return wrong(range[key], fmt::format("`{}` of {} must be a whole number to be cut into pieces, but is {}", key, name,
                                                     literal(range[key])));
        }
        const Result<size_t> pieces = count(range["pieces"], fmt::format("`pieces` of {}", name), 1);
        if (!pieces) return pieces.error();
        const auto from = static_cast<int64_t>(values.from), all = static_cast<int64_t>(values.to) - from;
        const auto n = static_cast<int64_t>(*pieces);
        if (n > all)
            return wrong(range["pieces"], fmt::format("{} has {} numbers, which cannot be cut into {} pieces; use fewer", name, all, n));
        values.listed.reserve(*pieces);
        for (int64_t k = 0; k < n; ++k) values.listed.push_back(fmt::format("{}:{}", from + all * k / n, from + all * (k + 1) / n));
        return values;
    }

    Status readParameters(const Json::Value& root) {
        const Json::Value none(Json::objectValue);
        const Json::Value& object = root.isMember("parameters") ? root["parameters"] : none;
        if (!object.isObject()) return wrong(object, "`parameters` must be an object: {\"fluid.viscosity\": [1e-6, 1e-3]}");
        std::vector<std::string> names = object.getMemberNames();  // sorted; the file's order counts
        std::sort(names.begin(), names.end(),
                  [&](const std::string& a, const std::string& b) { return object[a].getOffsetStart() < object[b].getOffsetStart(); });
        std::vector<SweepValues> values;
        values.reserve(names.size());
        for (const std::string& name : names) {
            if (name.empty() || name == "task" || name.find_first_of("{}=, \"\n\r") != std::string::npos)
                return wrong(object[name], fmt::format("`{}` cannot be the name of a parameter", name));
            Result<SweepValues> read = readValues(name, object[name]);
            if (!read) return read.error();
            values.push_back(std::move(*read));
            sweep_.parameters.push_back({name, placeAt(object[name]), {}});
        }
        return hypercube_ ? sample(object, values) : combine(object, values);
    }

    // A grid: all combinations; the last parameter changes fastest.
    Status combine(const Json::Value& object, const std::vector<SweepValues>& values) {
        double all = 1;
        for (const SweepValues& each : values) all *= static_cast<double>(each.listed.size());
        if (all > static_cast<double>(kMostTasks))
            return wrong(object, fmt::format("the grid has {:.6g} tasks, more than {}; use fewer values, or \"sampling\": \"{}\"", all,
                                             kMostTasks, kHypercube));
        sweep_.tasks = static_cast<size_t>(all);
        size_t repeat = sweep_.tasks;
        for (size_t p = 0; p < values.size(); ++p) {
            const std::vector<std::string>& listed = values[p].listed;
            repeat /= listed.size();
            sweep_.parameters[p].values.reserve(sweep_.tasks);
            for (size_t task = 0; task < sweep_.tasks; ++task) sweep_.parameters[p].values.push_back(listed[task / repeat % listed.size()]);
        }
        return ok();
    }

    // A Latin hypercube: each range is cut into as many equal parts as there are tasks, and each part is used once.
    Status sample(const Json::Value& object, const std::vector<SweepValues>& values) {
        if (values.empty()) return wrong(object, "a hypercube needs `parameters`; add one");
        SweepRandom random(seed_);
        sweep_.tasks = samples_;
        std::vector<size_t> part(samples_);
        for (size_t p = 0; p < values.size(); ++p) {
            std::iota(part.begin(), part.end(), size_t{0});
            for (size_t k = samples_; k > 1; --k) std::swap(part[k - 1], part[random.below(k)]);
            std::vector<std::string>& into = sweep_.parameters[p].values;
            into.reserve(samples_);
            for (const size_t each : part) {
                const double share = (static_cast<double>(each) + random.share()) / static_cast<double>(samples_);
                const std::vector<std::string>& listed = values[p].listed;
                if (listed.empty())
                    into.push_back(sweepNumber(values[p].at(share)));
                else
                    into.push_back(listed[std::min(static_cast<size_t>(share * static_cast<double>(listed.size())), listed.size() - 1)]);
            }
        }
        return ok();
    }

    // Every {NAME} is known, and every parameter is used; which of them each `run` is given.
    Status checkBraces() {
        std::vector<std::string> known = {"task"};
        for (const SweepParameter& parameter : sweep_.parameters) known.push_back(parameter.name);
        bool runs = false;
        for (const SweepCommand& command : sweep_.commands) {
            runs = runs || command.words.front() == "run";
            for (const std::string& word : command.words)
                for (size_t at = 0; (at = word.find('{', at)) != std::string::npos; ++at) {
                    if (word.compare(at, 2, kBrace) == 0) {
                        ++at;
                        continue;
                    }
                    const size_t end = word.find('}', at);
                    const std::string name = word.substr(at + 1, end == std::string::npos ? end : end - at - 1);
                    if (end != std::string::npos && std::find(known.begin(), known.end(), name) != known.end()) continue;
                    const std::string near = nearestName(name, known);
                    return badInput(fmt::format(
                        "{}: {{{}}} is neither {{task}} nor a parameter; {}", command.place, name,
                        near.empty() ? "add it to `parameters`, or write {{ for a brace" : fmt::format("did you mean {{{}}}?", near)));
                }
        }
        for (size_t p = 0; p < sweep_.parameters.size(); ++p) {
            const SweepParameter& parameter = sweep_.parameters[p];
            const std::string braces = fmt::format("{{{}}}", parameter.name);
            const bool named = std::any_of(sweep_.commands.begin(), sweep_.commands.end(), [&](const SweepCommand& command) {
                return std::any_of(command.words.begin(), command.words.end(),
                                   [&](const std::string& word) { return word.find(braces) != std::string::npos; });
            });
            if (!named && !runs)
                return badInput(fmt::format("{}: no command uses {}; write {} in a command, or use the verb run", parameter.place,
                                            parameter.name, braces));
            for (SweepCommand& command : sweep_.commands)
                if (command.words.front() == "run" && (!named || isOfScenes(parameter.name)) && !setsItself(command, parameter.name))
                    command.set.push_back(p);
        }
        return ok();
    }

    // Whether a command has --set NAME=...
    static bool setsItself(const SweepCommand& command, const std::string& name) {
        const std::string assigned = name + "=", joined = "--set=" + assigned;
        for (size_t k = 0; k < command.words.size(); ++k)
            if (command.words[k].starts_with(joined) ||
                (k > 0 && command.words[k - 1] == "--set" && command.words[k].starts_with(assigned)))
                return true;
        return false;
    }

    std::string_view text_;
    const std::string& file_;
    Sweep sweep_;
    bool hypercube_ = false;
    size_t samples_ = 0;
    uint64_t seed_ = 0;
};

}  // namespace

Result<Sweep> readSweep(std::string_view text, const std::string& file) { return SweepReader(text, file).read(); }

std::vector<std::string> wordsOf(const Sweep& sweep, const SweepCommand& command, size_t task, const std::string& taskFolder) {
    std::vector<std::string> words;
    words.reserve(command.words.size() + 2 * command.set.size());
    for (const std::string& word : command.words) {
        std::string made;
        for (size_t at = 0; at < word.size(); ++at) {
            if (word[at] != '{' || word.compare(at, 2, kBrace) == 0) {
                made += word[at];
                at += word[at] == '{' ? 1 : 0;
                continue;
            }
            const size_t end = word.find('}', at);
            const std::string name = word.substr(at + 1, end - at - 1);
            const auto found =
                std::find_if(sweep.parameters.begin(), sweep.parameters.end(), [&](const SweepParameter& p) { return p.name == name; });
            made += found == sweep.parameters.end() ? taskFolder : found->values[task];
            at = end;
        }
        words.push_back(std::move(made));
    }
    for (const size_t p : command.set) {
        words.emplace_back("--set");
        words.push_back(fmt::format("{}={}", sweep.parameters[p].name, sweep.parameters[p].values[task]));
    }
    return words;
}

namespace {

// The first word of a command. Error (badInput): neither a verb nor a program that can be started.
Status checkProgram(const std::string& program, const std::string& place) {
    if (program.find('/') == std::string::npos) {
        if (verbs().find(program) != nullptr) return ok();
        const std::vector<std::string> names = verbs().names();
        const std::string near = nearestName(program, names);
        return badInput(fmt::format("{}: '{}' is no verb of rivulet; {}", place, program,
                                    near.empty() ? fmt::format("a program that is searched in PATH is written /usr/bin/env {}", program)
                                                 : fmt::format("did you mean '{}'?", near)));
    }
    if (program.find(kTaskFolder) != std::string::npos) return ok();  // a command before it makes it
    std::error_code error;
    if (!fs::is_regular_file(program, error))
        return badInput(fmt::format("{}: the program {} does not exist; write its path, or /usr/bin/env NAME", place, program));
    if (::access(program.c_str(), X_OK) != 0)
        return badInput(fmt::format("{}: {} is not executable; write its interpreter first, for example /usr/bin/env python3 {}", place,
                                    program, program));
    return ok();
}

// Error (badInput): a verb would write its default output, which all tasks share.
Status checkDefaults(const SweepCommand& command) {
    struct Default {
        const char *verb, *option, *instead;
    };
    for (const Default& row :
         {Default{"voxelize", "--out", "/model.rvox"}, Default{"join", "--video", "/joined.mp4"}, Default{"chart", "--out", ""}}) {
        const std::vector<std::string>& words = command.words;
        if (words.front() != row.verb || hasOption(words, row.option)) continue;
        if (hasOption(words, "--point") || hasOption(words, "--sweep")) continue;  // of chart: another file is its output
        return badInput(fmt::format("{}: without {}, tasks of {} may write the same file; add for example {} {}{}", command.place,
                                    row.option, row.verb, row.option, kTaskFolder, row.instead));
    }
    return ok();
}

// The files and folders that tasks write, by the task. Error (badInput): two tasks write the same one.
class TaskOutputs {
  public:
    Status add(const std::vector<std::string>& words, size_t task, const std::string& place) {
        for (size_t k = 1; k < words.size(); ++k)
            for (const char* name : {"--out", "--stats", "--video", "--trace", "--save", "--record", "--json", "--slices", "--picture",
                                     "--pictures", "--markdown", "--scene", "--sweep"}) {
                if (!isOption(words[k], name)) continue;
                const size_t length = std::string_view(name).size();
                const std::string path = words[k].size() > length ? words[k].substr(length + 1) : k + 1 < words.size() ? words[k + 1] : "";
                if (path.find(kTaskFolder) != std::string::npos) continue;
                const auto [at, added] = tasks_.emplace(fs::path(path).lexically_normal().string(), task);
                if (added || at->second == task) continue;
                return badInput(fmt::format("{}: tasks {} and {} both write {} {}; write for example {} {{task}}/{}", place, at->second,
                                            task, name, path, name, fs::path(path).filename().string()));
            }
        return ok();
    }

    bool has(const std::string& path) const { return tasks_.contains(fs::path(path).lexically_normal().string()); }

  private:
    std::map<std::string, size_t> tasks_;
};

// Recordings and states that runs read, by their paths.
class TaskInputs {
  public:
    void add(const std::string& path, const SweepCommand& command, bool first) {
        if (!path.empty() && path.find(kTaskFolder) == std::string::npos) inputs_.emplace(path, Input{&command, first});
    }

    // Adds them to `files`, but for those that the tasks themselves write. Error (badInput): one cannot be read, and no command before its
    // own may make it.
    Status addTo(std::set<std::string>& files, const TaskOutputs& outputs) const {
        for (const auto& [path, input] : inputs_) {
            std::error_code none;
            if (outputs.has(path) || (!input.first && !fs::exists(path, none))) continue;
            if (Status readable = checkInput(path); !readable)
                return badInput(fmt::format("{}: {}", input.command->place, readable.error().message));
            files.insert(path);
        }
        return ok();
    }

  private:
    struct Input {
        const SweepCommand* command;
        bool first;  // of the commands
    };
    std::map<std::string, Input> inputs_;
};

}  // namespace

Result<std::set<std::string>> checkTasks(const Sweep& sweep) {
    std::set<std::string> files;
    TaskInputs inputs;
    TaskOutputs outputs;
    std::error_code error;
    fs::current_path(sweep.folder, error);
    if (error) return failed(fmt::format("the folder {} cannot be entered: {}", sweep.folder, error.message()));
    for (const SweepCommand& command : sweep.commands)
        if (Status named = sweep.tasks > 1 ? checkDefaults(command) : ok(); !named) return named.error();
    for (size_t task = 0; task < sweep.tasks; ++task)
        for (const SweepCommand& command : sweep.commands) {
            std::vector<std::string> words = wordsOf(sweep, command, task, kTaskFolder);
            if (task == 0 || command.words.front().find('{') != std::string::npos)
                if (Status sound = checkProgram(words.front(), command.place); !sound) return sound.error();
            if (words.front().find('/') == std::string::npos)
                if (Status alone = outputs.add(words, task, command.place); !alone) return alone.error();
            if (words.front() != "run") continue;
            const auto read = readRun({words.begin() + 1, words.end()});
            if (read && *read) {
                for (const SceneInput& input : inputsOf((*read)->scene)) files.insert(input.path);
                for (const std::string& path : {(*read)->replay, (*read)->resume})
                    inputs.add(path, command, &command == sweep.commands.data());
                continue;
            }
            if (read) return badInput(fmt::format("{}: --help is no command of a sweep; leave it out", command.place));
            const std::string& why = read.error().message;
            if (why.find(kTaskFolder) != std::string::npos) continue;  // a scene that a command before it makes
            std::string place = command.place;
            for (const SweepParameter& parameter : sweep.parameters)
                if (why.find(parameter.name + "=") != std::string::npos) place = parameter.place;
            return Error{fmt::format("{}: task {}: {}", place, task, why), read.error().fault};
        }
    if (Status added = inputs.addTo(files, outputs); !added) return added.error();
    return files;
}

}  // namespace rivulet
