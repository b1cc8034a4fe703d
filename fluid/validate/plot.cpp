// Plots of curves as SVG, by gnuplot.
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>

#include "engine/core/descriptor.h"
#include "engine/core/file.h"
#include "fluid/validate/physics_case.h"

namespace rivulet {

namespace {

// Text safe for a gnuplot string: without quotes and markup of enhanced text.
std::string inQuotes(std::string_view text) {
    std::string safe;
    for (const char c : text) safe += c == '"' || c == '\\' || c == '\n' ? ' ' : c;
    return '"' + safe + '"';
}

std::string scriptOf(const Plot& plot) {
    std::string script = fmt::format(
        "set terminal svg size 760,480 noenhanced font 'sans-serif,14' background 'white'\n"
        "set title {}\nset xlabel {}\nset ylabel {}\nset grid lc rgb '#dddddd'\nset border lc rgb '#666666'\nset key {} textcolor rgb "
        "'#333333'\n",
        inQuotes(plot.title), inQuotes(plot.x), inQuotes(plot.y), plot.curves.size() > 3 ? "outside bottom center horizontal " : "inside");
    if (plot.logX) script += "set logscale x\nset format x '%g'\n";
    if (plot.logY) script += "set logscale y\nset format y '%g'\n";
    if (!plot.ticks.empty()) {
        std::string names;
        for (size_t k = 0; k < plot.ticks.size(); ++k) names += fmt::format("{}{} {}", k > 0 ? ", " : "", inQuotes(plot.ticks[k]), k);
        script += fmt::format("set xtics ({}) rotate by -40\nset xrange [-0.5:{}]\nset format y '%g'\n", names,
                              static_cast<double>(plot.ticks.size()) - 0.5);
    }
    constexpr const char* kColours[] = {"#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#8c564b", "#444444", "#e377c2"};
    std::string curves, data;
    for (size_t k = 0; k < plot.curves.size(); ++k) {
        const Curve& c = plot.curves[k];
        if (c.points.empty()) continue;
        curves += fmt::format("{}'-' with {} lc rgb '{}' title {}", curves.empty() ? "plot " : ", ",
                              c.line ? "lines lw 2" : "points pt 7 ps 0.6", kColours[k % std::size(kColours)], inQuotes(c.name));
        for (const glm::dvec2& p : c.points) data += fmt::format("{:.9g} {:.9g}\n", p.x, p.y);
        data += "e\n";
    }
    return curves.empty() ? std::string() : script + curves + '\n' + data;
}

}  // namespace

Status drawPlot(const Plot& plot, const std::string& path) {
    const std::string script = scriptOf(plot);
    if (script.empty()) return ok();
    const int file = ::memfd_create("plot", 0);  // inherited by gnuplot, which reads it by its descriptor
    if (file < 0) return failed(fmt::format("no memory for the plot {}: {}", path, reasonOf(errno)));
    const bool whole = ::write(file, script.data(), script.size()) == static_cast<ssize_t>(script.size());
    ::lseek(file, 0, SEEK_SET);
    std::FILE* from = whole ? ::popen(fmt::format("exec gnuplot /dev/fd/{} 2>/dev/null", file).c_str(), "r") : nullptr;
    std::string svg;
    int status = -1;
    if (from != nullptr) {
        char piece[1 << 14];
        for (size_t got = 0; (got = std::fread(piece, 1, sizeof(piece), from)) > 0;) svg.append(piece, got);
        status = ::pclose(from);
    }
    ::close(file);
    if (status != -1 && WIFEXITED(status) && WEXITSTATUS(status) == 127) return failed("gnuplot is not installed: no plots are written");
    if (status != 0 || svg.empty()) return failed(fmt::format("gnuplot could not draw {}", path));
    return writeFileAtomic(path, svg);
}

}  // namespace rivulet
