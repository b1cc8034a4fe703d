// The table of results.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>
#include <set>

#include "demos/rivulet/sweep_folder.h"
#include "engine/core/file.h"
#include "engine/core/json_parse.h"

namespace rivulet {

namespace {

// A cell as RFC 4180 writes it.
std::string tableCell(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::vector<std::string> tableCells(std::string_view line) {
    std::vector<std::string> cells(1);
    bool quoted = false;
    for (size_t at = 0; at < line.size(); ++at) {
        if (line[at] == '"' && quoted && at + 1 < line.size() && line[at + 1] == '"')
            cells.back() += line[++at];
        else if (line[at] == '"')
            quoted = !quoted;
        else if (line[at] == ',' && !quoted)
            cells.emplace_back();
        else
            cells.back() += line[at];
    }
    return cells;
}

bool isTime(const std::string& part) { return part == "passes" || part == "ms" || part.ends_with("Ms") || part.starts_with("wall"); }

void addNumbers(const Json::Value& value, std::string_view text, const std::string& name, bool time,
                std::vector<std::pair<std::string, std::string>>& numbers) {
    if (value.isNumeric()) {
        const auto begin = static_cast<size_t>(value.getOffsetStart()), end = static_cast<size_t>(value.getOffsetLimit());
        numbers.emplace_back((time ? "time." : "") + name, text.substr(begin, end - begin));
    } else if (value.isArray() || value.isObject()) {
        for (auto each = value.begin(); each != value.end(); ++each) {
            const std::string part = value.isArray() ? std::to_string(each.index()) : each.name();
            addNumbers(*each, text, name.empty() ? part : fmt::format("{}.{}", name, part), time || isTime(part), numbers);
        }
    }
}

// Numbers first, then times, each in the order of the alphabet.
struct ColumnOrder {
    bool operator()(const std::string& a, const std::string& b) const {
        const bool timeA = a.starts_with("time."), timeB = b.starts_with("time.");
        return timeA != timeB ? timeB : a < b;
    }
};

// The results as text: the lines of an older table are kept as they are, unless a new task brings a new column.
class ResultTable {
  public:
    explicit ResultTable(const Sweep& sweep) : sweep_(sweep) {
        fixed_ = "task";
        taken_.reserve(1 + sweep.parameters.size());
        taken_.emplace_back("task");
        for (const SweepParameter& parameter : sweep.parameters) {
            fixed_ += ',' + tableCell(parameter.name);
            taken_.push_back(parameter.name);
        }
    }

    // Takes the lines of a table of the same sweep that are among `ended`. Others would leave columns that no task has: nothing is taken.
    void take(std::string_view csv, const std::set<size_t>& ended) {
        size_t at = csv.find('\n');
        const std::string_view header = csv.substr(0, at);
        if (csv.find('\r') != std::string_view::npos) return;  // saved by a spreadsheet
        if (at == std::string_view::npos || !header.starts_with(fixed_) || (header.size() > fixed_.size() && header[fixed_.size()] != ','))
            return;
        std::vector<std::string> columns = tableCells(header);
        columns.erase(columns.begin(), columns.begin() + static_cast<ptrdiff_t>(1 + sweep_.parameters.size()));
        std::map<size_t, std::string> lines;
        for (++at; at < csv.size();) {
            const size_t end = csv.find('\n', at);
            if (end == std::string_view::npos) return;  // cut off
            const std::string_view line = csv.substr(at, end - at);
            size_t task = 0;
            if (std::from_chars(line.data(), line.data() + line.size(), task).ec != std::errc() || !ended.contains(task)) return;
            lines.emplace(task, line);
            at = end + 1;
        }
        columns_ = {columns.begin(), columns.end()};
        lines_ = std::move(lines);
    }

    bool has(size_t task) const { return lines_.contains(task); }

    void add(size_t task, const std::vector<std::pair<std::string, std::string>>& numbers) {
        std::map<std::string, std::string> row;
        for (const auto& [name, number] : numbers) {
            const bool taken = std::find(taken_.begin(), taken_.end(), name) != taken_.end();
            row.emplace(taken ? "stats." + name : name, number);
        }
        const size_t before = columns_.size();
        const std::vector<std::string> old(columns_.begin(), columns_.end());
        for (const auto& [name, number] : row) columns_.insert(name);
        if (columns_.size() != before)
            for (auto& [k, line] : lines_) {
                const std::vector<std::string> cells = tableCells(line);
                std::map<std::string, std::string> values;
                for (size_t c = 0; c < old.size(); ++c) {
                    const size_t at = c + 1 + sweep_.parameters.size();
                    if (at < cells.size()) values.emplace(old[c], cells[at]);
                }
                line = lineOf(k, values);
            }
        lines_[task] = lineOf(task, row);
    }

    TableSize size() const { return {.rows = lines_.size(), .numbers = columns_.size()}; }

    std::string text() const {
        std::string csv = fixed_;
        for (const std::string& name : columns_) csv += ',' + tableCell(name);
        csv += '\n';
        for (const auto& [task, line] : lines_) csv += line + '\n';
        return csv;
    }

  private:
    std::string lineOf(size_t task, const std::map<std::string, std::string>& values) const {
        std::string line = std::to_string(task);
        for (const SweepParameter& parameter : sweep_.parameters) line += ',' + tableCell(parameter.values[task]);
        for (const std::string& name : columns_) {
            const auto at = values.find(name);
            line += ',' + (at == values.end() ? std::string() : at->second);
        }
        return line;
    }

    const Sweep& sweep_;
    std::string fixed_;               // the columns before the numbers, as text
    std::vector<std::string> taken_;  // their names
    std::set<std::string, ColumnOrder> columns_;
    std::map<size_t, std::string> lines_;
};

}  // namespace

Result<std::vector<std::pair<std::string, std::string>>> numbersOf(const std::string& statsFile) {
    std::vector<std::pair<std::string, std::string>> numbers;
    std::error_code none;
    if (!std::filesystem::exists(statsFile, none)) return numbers;
    const Result<std::string> text = readFile(statsFile);
    if (!text) return text.error();
    const Result<Json::Value> root = parseJson(*text, statsFile);
    if (!root) return root.error();
    addNumbers(*root, *text, "", false, numbers);
    return numbers;
}

Descriptor SweepFolder::takeTable() const {
    Result<Descriptor> next = lockFile(file("results.next"), false);
    return next ? std::move(*next) : Descriptor();
}

// Two locks: one process collects, and one waits for it. A task that ends while another waits is in the table of that one, which reads the
// folder after it has released results.next.
Status SweepFolder::collectSoon(const Sweep& sweep, size_t task) const {
    Descriptor next = takeTable();
    if (!next.valid()) return ok();
    const Result<TableSize> collected = collect(sweep, task, &next);
    return collected ? ok() : Status(collected.error());
}

Result<TableSize> SweepFolder::collect(const Sweep& given, std::optional<size_t> again, Descriptor* next) const {
    const std::string name = file("results.csv");
    const Result<Descriptor> lock = lockFile(file("results.lock"), true);
    if (!lock) return lock.error();
    if (next != nullptr) (void)next->close();
    const std::vector<size_t> endedNow = endedTasks();
    std::optional<Sweep> grown;  // since this process read it
    if (!endedNow.empty() && endedNow.back() >= given.tasks) {
        const std::string kept = file("sweep.json");
        const Result<std::string> text = readFile(kept);
        if (!text) return text.error();
        Result<Sweep> read = readSweep(*text, kept);
        if (!read) return read.error();
        grown = std::move(*read);
    }
    const Sweep& sweep = grown ? *grown : given;
    std::set<size_t> all;
    for (const size_t task : endedNow)
        if (task < sweep.tasks) all.insert(task);
    ResultTable table(sweep);
    std::string before;
    if (Result<std::string> old = readFile(name)) {
        before = std::move(*old);
        std::set<size_t> kept = all;
        if (again) kept.erase(*again);
        table.take(before, kept);
    }
    for (const size_t task : all) {
        if (table.has(task)) continue;
        Result<std::vector<std::pair<std::string, std::string>>> numbers = numbersOf(ended(task) + "/stats.json");
        if (!numbers) return numbers.error();
        table.add(task, *numbers);
    }
    const std::string now = table.text();
    if (now != before)
        if (Status written = writeFileAtomic(name, now, 0666, Sync::none); !written) return written.error();
    return table.size();
}

}  // namespace rivulet
