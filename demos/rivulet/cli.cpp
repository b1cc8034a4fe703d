#include "demos/rivulet/cli.h"

#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <system_error>

#include "engine/core/message_line.h"

namespace rivulet {

namespace {

// Never fails: stderr may be closed, or a terminal that has gone.
void printToStderr(const std::string& text) {
    (void)std::fwrite(text.data(), 1, text.size(), stderr);
    (void)std::fflush(stderr);
}

}  // namespace

int report(const Error& error) {
    printToStderr(fmt::format("rivulet: {}\n", messageLine(error.message)));
    return error.fault == Fault::badInput ? kBadUse : kFailed;
}

void flushOutput() {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
    throw std::system_error(errno != 0 ? errno : EIO, std::generic_category());
}

Status checkWord(std::string_view what, std::string_view word, std::span<const std::string> names) {
    if (std::find(names.begin(), names.end(), word) != names.end()) return ok();
    std::string near = nearestName(word, names);
    if (!near.empty()) return badInput(fmt::format("unknown {} '{}'; did you mean '{}'?", what, word, near));
    return badInput(fmt::format("unknown {} '{}'; use one of: {}", what, word, fmt::join(names, ", ")));
}

namespace {

// CLI11's message without line breaks and the final period, to be continued as a sentence.
std::string sentence(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
    for (char& c : text)
        if (c == '\n') c = ' ';
    return text;
}

Status checkExtras(const CLI::App& app) {
    std::vector<std::string> extras = app.remaining();
    if (extras.empty()) return ok();
    auto dashed = std::find_if(extras.begin(), extras.end(), [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
    if (dashed == extras.end()) return badInput(fmt::format("unexpected argument '{}'", extras.front()));
    std::vector<std::string> names;
    for (const CLI::Option* option : app.get_options()) {
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
    }
    return checkWord("option", dashed->substr(0, dashed->find('=')), names);
}

}  // namespace

struct ArgumentReader::Impl {
    CLI::App app;
};

ArgumentReader::ArgumentReader(std::string_view verb, std::string_view doc) : impl_(std::make_unique<Impl>()) {
    impl_->app.description(std::string(doc));
    impl_->app.name(fmt::format("rivulet {}", verb));
    impl_->app.allow_extras();  // read() refuses them and names the nearest option
}

ArgumentReader::~ArgumentReader() = default;

void ArgumentReader::positional(const std::string& name, const std::string& doc, std::string& value, bool required) {
    impl_->app.add_option(name, value, doc)->required(required)->type_name("");
}

void ArgumentReader::positional(const std::string& name, const std::string& doc, std::vector<std::string>& values) {
    impl_->app.add_option(name, values, doc)->type_name("");
}

void ArgumentReader::flag(const std::string& name, const std::string& doc, bool& value) { impl_->app.add_flag(name, value, doc); }

void ArgumentReader::option(const std::string& name, const std::string& type, const std::string& doc, std::string& value) {
    impl_->app.add_option(name, value, doc)
        ->type_name(type)
        ->check(CLI::Validator([](std::string& text) { return text.empty() ? std::string("the value must not be empty") : std::string(); },
                               ""));
}

void ArgumentReader::option(const std::string& name, const std::string& type, const std::string& doc, std::vector<std::string>& values) {
    impl_->app.add_option(name, values, doc)->type_name(type)->allow_extra_args(false);
}

namespace {

// A range check that refuses NaN too.
template <class T>
CLI::Validator within(T min, T max, bool strict = true) {
    return CLI::Validator(
        [min, max, strict](std::string& text) {
            T value{};
            if (CLI::detail::lexical_cast(text, value) && (!strict || (value >= min && value <= max))) return std::string();
            return fmt::format("the value must be a {}number from {} to {}, but is '{}'", std::is_integral_v<T> ? "whole " : "", min, max,
                               text);
        },
        "");
}

}  // namespace

void ArgumentReader::option(const std::string& name, const std::string& type, const std::string& doc, std::optional<int>& value, int min,
                            int max, bool strict) {
    impl_->app.add_option(name, value, doc)->type_name(type)->check(within(min, max, strict));
}

void ArgumentReader::option(const std::string& name, const std::string& type, const std::string& doc, std::optional<double>& value,
                            double min, double max) {
    impl_->app.add_option(name, value, doc)->type_name(type)->check(within(min, max));
}

void ArgumentReader::exclude(const std::string& name, const std::string& other) {
    impl_->app.get_option(name)->excludes(impl_->app.get_option(other));
}

void ArgumentReader::footer(const std::string& text) { impl_->app.footer(text); }

std::optional<int> ArgumentReader::read(const Arguments& arguments) {
    const Result<bool> read = parse(arguments);
    if (!read) return report(read.error());
    return *read ? std::nullopt : std::optional<int>(kDone);
}

Result<bool> ArgumentReader::parse(const Arguments& arguments) {
    CLI::App& app = impl_->app;
    auto refuse = [&app](const std::string& why) { return badInput(fmt::format("{} (see '{} --help')", why, app.get_name())); };
    try {
        app.parse(Arguments(arguments.rbegin(), arguments.rend()));
    } catch (const CLI::CallForHelp&) {
        fmt::print("{}", app.help());
        return false;
    } catch (const CLI::ParseError& error) {
        // After an unknown option, CLI11 may report its value as a missing or surplus argument: the unknown option is reported first.
        Status extras = checkExtras(app);
        return refuse(extras ? sentence(error.what()) : extras.error().message);
    }
    if (Status extras = checkExtras(app); !extras) return refuse(extras.error().message);
    return true;
}

Result<std::pair<int, int>> parseSize(const std::string& text) {
    int width = 0, height = 0, end = 0;
    bool plain = !text.empty() && std::isdigit(static_cast<unsigned char>(text[0])) != 0;
    if (!plain || text.size() > 11 || std::sscanf(text.c_str(), "%5dx%5d%n", &width, &height, &end) != 2 ||
        static_cast<size_t>(end) != text.size() || width < 1 || height < 1 || width > 16384 || height > 16384)
        return badInput(fmt::format("--size must be WIDTHxHEIGHT in pixels, each 1 to 16384, for example 1280x720, but is '{}'", text));
    return std::pair(width, height);
}

namespace {
constexpr size_t kLabel = 60;  // characters
}

Progress::Progress(const std::string& label) : label_(messageLine(label, kLabel)), terminal_(isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
    if (drawn_) printToStderr("\r\033[K");
}

void Progress::show(double share, std::string_view note) {
    auto now = std::chrono::steady_clock::now();
    if (!terminal_ || (drawn_ && now - last_ < std::chrono::milliseconds(100))) return;
    last_ = now;
    drawn_ = true;
    constexpr int kCells = 32;
    share = std::clamp(share, 0.0, 1.0);
    int filled = static_cast<int>(share * kCells);
    printToStderr(fmt::format("\r\033[K{} [{:#<{}}{:.<{}}] {:3.0f} %  {}", label_, "", filled, "", kCells - filled, 100 * share,
                              messageLine(note, kLabel)));
}

}  // namespace rivulet
