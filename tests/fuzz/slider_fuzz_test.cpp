// The slider fuzzer: for every value that a panel permits, nothing becomes NaN, nothing is lost, no speed passes the step's limit, nothing
// crashes. test_fuzz alone runs a sample. RIVULET_FUZZ in the environment asks for more:
//   full             every Param's ends and middle, all pairs of ends, 2,000 combinations, each with every method
//   full 3/16        the third of sixteen parts of that
//   pbf random 17    one case, as a failure names it (fuzz_case.h: the names)
//
// With --gtest_filter for one method or kind: '*Pairs/dfsph'.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <map>

#include "fluid/sim/methods/method.h"
#include "tests/fuzz/fuzz_run.h"

namespace rivulet::fuzz {

namespace {

struct Mode {
    bool full = false;
    size_t part = 1, parts = 1;
    std::string one;
};

Mode mode() {
    const char* asked = std::getenv("RIVULET_FUZZ");
    const std::string text = asked != nullptr ? asked : "";
    Mode m;
    if (text.empty() || text == "full") {
        m.full = !text.empty();
    } else if (std::sscanf(text.c_str(), "full %zu/%zu", &m.part, &m.parts) == 2 && m.part >= 1 && m.part <= m.parts) {
        m.full = true;
    } else {
        m.one = text;
    }
    return m;
}

// Digits are alike: what is refused, by its kind.
std::string kindOf(const std::string& sentence) {
    std::string kind;
    for (const char c : sentence) {
        const bool digit = (c >= '0' && c <= '9') || c == '.' || c == '-';
        if (!digit)
            kind += c;
        else if (kind.empty() || kind.back() != '#')
            kind += '#';
    }
    return kind.substr(0, 110);
}

// Runs the cases one after the other, fails for each that fails, and reports how many were refused, so that not all can be refused.
// Returns in how many water slept.
size_t runAll(const std::vector<std::string>& names, size_t leastRun) {
    constexpr size_t kShown = 12;
    size_t ran = 0, refused = 0, failed = 0, slowed = 0, limited = 0, drags = 0, slept = 0;
    double seconds = 0, longest = 0;
    std::string slowest;
    std::map<std::string, size_t> refusals;
    for (const std::string& name : names) {
        const Result<Case> c = caseOf(name);
        if (!c) {
            ADD_FAILURE() << c.error().message;
            continue;
        }
        const Outcome o = run(*c);
        ++ran;
        seconds += o.seconds;
        if (o.seconds > longest) {
            longest = o.seconds;
            slowest = name;
        }
        drags += static_cast<size_t>(o.refusedDrags);
        slowed += o.slowed > 0 ? 1 : 0;
        slept += o.slept > 0 ? 1 : 0;
        limited += o.limited > 0 ? 1 : 0;
        if (o.verdict == Outcome::Verdict::refused) {
            ++refused;
            ++refusals[kindOf(o.sentence)];
        }
        if (o.verdict != Outcome::Verdict::failed) continue;
        if (++failed <= kShown)
            ADD_FAILURE() << report(*c, o);
        else
            fmt::print("also: {}: {}\n", name, o.sentence);
    }
    fmt::print(
        "{} cases: {} failed, {} refused at the start (and {} drags), {} had something limited, {} had water that slept, {} became dear; "
        "{:.1f} s, at most {:.1f} s: {}\n",
        ran, failed, refused, drags, limited, slept, slowed, seconds, longest, slowest);
    for (const auto& [kind, count] : refusals) fmt::print("  refused {:4}: {}\n", count, kind);
    EXPECT_GE(ran - refused, leastRun) << "too much is refused to have tried anything";
    return slept;
}

// Every so many of them, `count` in all, the first picked by the list itself.
std::vector<std::string> sampled(const std::vector<std::string>& all, size_t count) {
    if (all.size() <= count) return all;
    std::vector<std::string> some;
    for (size_t k = 0; k < count; ++k) {
        const size_t from = k * all.size() / count, to = (k + 1) * all.size() / count;
        some.push_back(all[from + hashOf(all[from]) % (to - from)]);
    }
    return some;
}

std::vector<std::string> partOf(const std::vector<std::string>& all, const Mode& m) {
    std::vector<std::string> some;
    for (size_t k = m.part - 1; k < all.size(); k += m.parts) some.push_back(all[k]);
    return some;
}

std::vector<std::string> combinations(const std::string& method, size_t count) {
    std::vector<std::string> names;
    for (size_t k = 0; k < count; ++k) names.push_back(fmt::format("{} random {}", method, k));
    return names;
}

class SliderFuzz : public ::testing::TestWithParam<std::string> {
  protected:
    // A part of the full list, or a sample of another.
    size_t runThese(const std::vector<std::string>& full, const std::vector<std::string>& sample, size_t count) {
        const Mode m = mode();
        const std::vector<std::string> names = m.full ? partOf(full, m) : sampled(sample, count);
        return runAll(names, names.size() / 2);
    }
};

}  // namespace

TEST_P(SliderFuzz, EveryParamAloneOverItsWholeRange) {
    const std::vector<std::string> sample = singles(GetParam(), true);
    runThese(singles(GetParam(), false), sample, sample.size());
}

TEST_P(SliderFuzz, PairsOfParamsAtTheirEnds) { runThese(pairs(GetParam(), false), pairs(GetParam(), true), 40); }

TEST_P(SliderFuzz, ParamsOfAPoolThatSleeps) {
    const std::vector<std::string> sample = sleeping(GetParam(), true);
    if (sample.empty()) return;  // a method without fluid.sleep
    EXPECT_GT(runThese(sleeping(GetParam(), false), sample, 8), 0U) << "water sleeps in none";
}

TEST_P(SliderFuzz, RandomCombinations) { runThese(combinations(GetParam(), 2000), combinations(GetParam(), 2000), 12); }

// Where one case is asked for, there are no others.
INSTANTIATE_TEST_SUITE_P(Every, SliderFuzz, ::testing::ValuesIn(mode().one.empty() ? methods().names() : std::vector<std::string>()),
                         [](const ::testing::TestParamInfo<std::string>& method) { return method.param; });
GTEST_ALLOW_UNINSTANTIATED_PARAMETERIZED_TEST(SliderFuzz);

// By its name alone a case is there again: the one that was asked for, else such as were found to fail once.
class NamedCase : public ::testing::TestWithParam<std::string> {};

TEST_P(NamedCase, IsRepeatedByItsName) {
    const Result<Case> c = caseOf(GetParam());
    ASSERT_TRUE(c) << c.error().message;
    const Outcome o = run(*c);
    EXPECT_NE(o.verdict, Outcome::Verdict::failed) << report(*c, o);
    fmt::print("{}{} ({:.1f} s, {} notices)\n", o.verdict == Outcome::Verdict::refused ? "refused: " : "", o.sentence, o.seconds,
               o.limited);
    const std::string told = report(*c, o);
    EXPECT_NE(told.find(fmt::format("RIVULET_FUZZ=\"{}\"", GetParam())), std::string::npos) << told;
}

INSTANTIATE_TEST_SUITE_P(Cases, NamedCase,
                         ::testing::ValuesIn(mode().one.empty()
                                               ? std::vector<std::string>{
                                                     // Pressures of an iteration that diverges were no number.
                                                     "dfsph pair tank fluid.dfsph.relaxation=1 fluid.dfsph.maxIterations=1000",
                                                     // Took all the memory there is.
                                                     "pbf start forces emitters.0.radius=100",
                                                     // Factors of the smoothing kernel were infinite.
                                                     "wcsph start tank fluid.spacing=1e-05",
                                                     // Those of forces were, with a kernel whose own were not.
                                                     "wcsph pair forces fluid.kernel=cubic_spline fluid.spacing=1e-05",
                                                 }
                                               : std::vector<std::string>{mode().one}));

}  // namespace rivulet::fuzz
