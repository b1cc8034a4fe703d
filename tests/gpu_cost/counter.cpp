// A plugin of Oclgrind (Price and McIntosh-Smith 2015) that counts what OpenCL kernels execute: operations by class, bytes, the memory that
// a work group and a dispatch touch, and how unevenly the threads of a warp are loaded. Writes a row for each kernel to the file
// RIVULET_COUNTS when the program ends; with RIVULET_COUNT_VARIANTS a row for each of its variants. All figures are for a thread, means
// over all dispatches of the row, unless they say otherwise. A program that comes from a cache has no text that says which variant it is.
//
// Arithmetic on a vector counts once for each component, and a * b + c, where the compiler may contract it, once. Operations that cost a
// GPU nothing are not counted: moves between registers, which Oclgrind sees as loads and stores of private memory, phi nodes, casts of
// pointers, and parts of vectors taken out or put in. Threads in step: each part of the code costs what the thread in it with the most
// operations has executed there, so that one thread in step has the operations that it has alone.
#include <llvm/Analysis/LoopInfo.h>
#include <llvm/IR/CFG.h>
#include <llvm/IR/Constants.h>
#include <llvm/IR/DerivedTypes.h>
#include <llvm/IR/Dominators.h>
#include <llvm/IR/Instructions.h>
#include <llvm/Support/CommandLine.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "oclgrind/Context.h"
#include "oclgrind/Kernel.h"
#include "oclgrind/KernelInvocation.h"
#include "oclgrind/Memory.h"
#include "oclgrind/Plugin.h"
#include "oclgrind/Program.h"
#include "oclgrind/WorkGroup.h"
#include "oclgrind/WorkItem.h"

namespace {

enum Class { arithmetic, special, integer, branch, uniform, load, store, atomic, shared, barrier, kClasses };
constexpr const char* kNames[kClasses] = {"arithmetic", "special", "integers", "branches", "uniforms",
                                          "loads",      "stores",  "atomics",  "shared",   "barriers"};
constexpr size_t kSector = 32;                          // bytes: what a GPU's caches exchange with memory
constexpr std::array<size_t, 3> kWidths = {8, 32, 64};  // threads that a device runs in step
constexpr unsigned kGlobal = 1, kConstant = 2, kLocal = 3;

struct Cost {
    Class of = integer;
    double count = 0;
};

// A function as one call runs it: a call that the compiler has not inlined is followed as if it had. A part is a block, or what is left of
// one after such a call. Parts are numbered in the order in which threads in step go through them.
struct Context {
    struct Step {
        Cost cost = {};
        bool begins = false;        // a part
        unsigned part = 0;          // if it begins one
        Context* called = nullptr;  // by a call of a function with a body
        bool returns = false;       // to the caller
    };
    Context* caller = nullptr;
    std::unordered_map<const llvm::Instruction*, Step> steps = {};
};

double sumOf(const std::array<double, kClasses>& count) {
    double sum = 0;
    for (const double c : count) sum += c;
    return sum;
}

struct Thread {
    struct Visit {
        unsigned part = 0;
        double operations = 0;
    };
    std::array<double, kClasses> count{};
    std::vector<Visit> visits = {};  // of parts, in turn
    double noted = 0;                // operations of the instruction at hand: its accesses of memory are reported before it
    Context* context = nullptr;
    void add(Class of, double operations) { count[of] += operations, noted += operations; }
    double operations() const { return sumOf(count); }
};

// A count that cannot be: the program ends, and no table is written.
void insist(bool holds, const char* what) {
    if (holds) return;
    std::fprintf(stderr, "tests/gpu_cost/counter.cpp: %s\n", what);
    std::_Exit(3);
}

// Sums over all dispatches of one kernel.
struct Sums {
    double calls = 0, threads = 0, loadBytes = 0, storeBytes = 0, sectors = 0, groupBytes = 0, readBytes = 0, writtenBytes = 0;
    std::array<double, kClasses> count{};
    std::array<double, kWidths.size()> inStep{};  // operations of threads that go through the code in step
    double longest = 0, longestLoads = 0;         // of the longest thread of each dispatch
    double groups = 0;
    std::set<std::string> variants;
};

// A kernel's path below shaders and its defines, from its text: the defines are its first lines, and #line names its files. The size of its
// work groups is none of its variants.
struct Origin {
    std::string path, variant;
};
Origin originOf(const oclgrind::Kernel& kernel) {
    const std::string file = "/" + kernel.getName() + ".kernel\"";
    Origin origin{kernel.getName(), ""};
    std::set<std::string> defines;
    std::istringstream lines(kernel.getProgram()->getSource());
    bool first = true;
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string directive, name, value;
        words >> directive >> name >> value;
        first = first && directive == "#define";
        if (first && name != "LOCAL_SIZE") defines.insert(name + "=" + value);
        const size_t at = line.find("shaders/");
        if (directive == "#line" && line.ends_with(file) && at != std::string::npos)
            origin.path = line.substr(at + 8, line.size() - at - 8 - std::string(".kernel\"").size());
    }
    for (const std::string& define : defines) origin.variant += (origin.variant.empty() ? "" : ";") + define;
    if (origin.variant.empty()) origin.variant = "-";
    return origin;
}

double widthOf(const llvm::Type* type) {
    if (const auto* vector = llvm::dyn_cast<llvm::FixedVectorType>(type))
        return vector->getNumElements() == 4 ? 4 : vector->getNumElements();
    return 1;
}

class Counter final : public oclgrind::Plugin {
  public:
    explicit Counter(const oclgrind::Context* context) : Plugin(context) {}
    ~Counter() override { write(); }
    bool isThreadSafe() const override { return false; }

    void kernelBegin(const oclgrind::KernelInvocation* invocation) override {
        const auto [known, fresh] = origins_.try_emplace(invocation->getKernel()->getProgram()->getUID());
        if (fresh) known->second = originOf(*invocation->getKernel());
        const Origin& origin = known->second;
        sums_ = &all_[std::getenv("RIVULET_COUNT_VARIANTS") != nullptr ? origin.path + "," + origin.variant : origin.path];
        sums_->variants.insert(origin.variant);
        ++sums_->calls;
        root_ = rootOf(*invocation->getKernel());
        read_.clear();
        written_.clear();
        longest_ = {};
    }
    void kernelEnd(const oclgrind::KernelInvocation*) override {
        sums_->readBytes += static_cast<double>(kSector * read_.size());
        sums_->writtenBytes += static_cast<double>(kSector * written_.size());
        sums_->longest += sumOf(longest_);
        sums_->longestLoads += longest_[load] + longest_[atomic];
    }
    void workGroupBegin(const oclgrind::WorkGroup* group) override {
        const oclgrind::Size3 size = group->getGroupSize();
        threads_.assign(size.x * size.y * size.z, {});
        for (Thread& t : threads_) t.context = root_;
        touched_.clear();
        merged_.clear();
        occurrence_.clear();
    }
    void workGroupComplete(const oclgrind::WorkGroup*) override {
        sums_->threads += static_cast<double>(threads_.size());
        ++sums_->groups;
        sums_->groupBytes += static_cast<double>(kSector * touched_.size());
        for (const Thread& t : threads_) {
            for (size_t k = 0; k < kClasses; ++k) sums_->count[k] += t.count[k];
            if (t.operations() > sumOf(longest_)) longest_ = t.count;
        }
        for (size_t first = 0; first < threads_.size(); ++first)
            insist(about(inStep(first, first + 1), threads_[first].operations()), "a thread alone has other operations in step");
        for (size_t w = 0; w < kWidths.size(); ++w)
            for (size_t first = 0; first < threads_.size(); first += kWidths[w]) {
                const size_t end = std::min(first + kWidths[w], threads_.size());
                const double together = inStep(first, end);
                double most = 0, all = 0;
                for (size_t k = first; k < end; ++k) most = std::max(most, threads_[k].operations()), all += threads_[k].operations();
                insist(together >= most - 1.0e-6 * most, "threads in step have fewer operations than one of them");
                insist(together <= all + 1.0e-6 * all, "threads in step have more operations than one after the other");
                sums_->inStep[w] += together * static_cast<double>(end - first);
            }
        for (const auto& [at, warps] : merged_)
            for (const auto& occurrences : warps)
                for (const auto& sectors : occurrences) sums_->sectors += static_cast<double>(sectors.size());
    }
    void instructionExecuted(const oclgrind::WorkItem* item, const llvm::Instruction* instruction, const oclgrind::TypedValue&) override {
        Thread& thread = threadOf(item);
        const auto found = thread.context->steps.find(instruction);
        insist(found != thread.context->steps.end(), "an instruction is not of the function that runs");
        const Context::Step& step = found->second;
        if (step.begins) thread.visits.push_back({step.part, 0});
        thread.add(step.cost.of, step.cost.count);
        thread.visits.back().operations += thread.noted;
        thread.noted = 0;
        if (step.called != nullptr) thread.context = step.called;
        if (step.returns) thread.context = thread.context->caller;
    }
    void memoryLoad(const oclgrind::Memory* memory, const oclgrind::WorkItem* item, size_t address, size_t size) override {
        unsigned space = memory->getAddressSpace();  // constants are in global memory too
        if (const auto* by = llvm::dyn_cast<llvm::LoadInst>(item->getCurrentInstruction())) space = by->getPointerAddressSpace();
        if (space == kLocal) threadOf(item).add(shared, 1);
        if (space == kConstant) threadOf(item).add(uniform, 1);
        if (space != kGlobal) return;
        threadOf(item).add(load, 1);
        sums_->loadBytes += static_cast<double>(size);
        touch(item, address, size, read_);
    }
    void memoryStore(const oclgrind::Memory* memory, const oclgrind::WorkItem* item, size_t address, size_t size, const uint8_t*) override {
        const unsigned space = memory->getAddressSpace();
        if (space == kLocal) threadOf(item).add(shared, 1);
        if (space != kGlobal) return;
        threadOf(item).add(store, 1);
        sums_->storeBytes += static_cast<double>(size);
        touch(item, address, size, written_);
    }
    void memoryAtomicLoad(const oclgrind::Memory* memory, const oclgrind::WorkItem* item, oclgrind::AtomicOp, size_t address,
                          size_t size) override {
        if (memory->getAddressSpace() != kGlobal) return;
        threadOf(item).add(atomic, 1);
        touch(item, address, size, read_);
    }
    void memoryAtomicStore(const oclgrind::Memory* memory, const oclgrind::WorkItem* item, oclgrind::AtomicOp, size_t address,
                           size_t size) override {
        if (memory->getAddressSpace() == kGlobal) touch(item, address, size, written_);
    }

  private:
    static bool about(double a, double b) { return std::abs(a - b) <= 1.0e-6 * std::max(a, b); }

    static Cost costOfCall(const llvm::CallInst& call) {
        const llvm::Function* f = call.getCalledFunction();
        if (f == nullptr || f->isIntrinsic()) {
            if (f == nullptr || f->getName().startswith("llvm.dbg") || f->getName().startswith("llvm.lifetime")) return {};
            return {call.getType()->isFPOrFPVectorTy() ? arithmetic : integer, widthOf(call.getType())};
        }
        std::string name = f->getName().str();  // _Z3dotDv3_fS_: length and name
        if (name.starts_with("_Z")) {
            char* end = nullptr;
            const size_t length = std::strtoul(name.c_str() + 2, &end, 10);
            name = std::string(end, length);
        } else if (!f->isDeclaration()) {
            return {};  // a function of the kernel's own: its body is counted
        }
        const double width = widthOf(call.arg_size() > 0 ? call.getArgOperand(0)->getType() : call.getType());
        if (!f->isDeclaration()) return {};
        if (name == "dot") return {arithmetic, width};
        if (name == "length" || name == "distance" || name == "normalize") return {arithmetic, 2 * width + 8};
        if (name == "cross") return {arithmetic, 6};
        if (name == "mix" || name == "clamp") return {arithmetic, 2 * width};
        for (const char* slow : {"sqrt", "rsqrt", "exp", "log", "pow", "sin", "cos", "tan", "acos", "asin", "atan", "atan2", "native_"})
            if (name.starts_with(slow)) return {special, width};
        if (name == "barrier") return {barrier, 1};
        if (name.starts_with("get_") || name.starts_with("atom")) return {};
        return {call.getType()->isFPOrFPVectorTy() ? arithmetic : integer, width};
    }

    static Cost computeCost(const llvm::Instruction* i) {
        const double width = widthOf(i->getType());
        switch (i->getOpcode()) {
            case llvm::Instruction::FAdd:
            case llvm::Instruction::FSub:
            case llvm::Instruction::FMul:
            case llvm::Instruction::FNeg:
            case llvm::Instruction::FCmp:
            case llvm::Instruction::FPToSI:
            case llvm::Instruction::FPToUI:
            case llvm::Instruction::SIToFP:
            case llvm::Instruction::UIToFP:
            case llvm::Instruction::FPTrunc:
            case llvm::Instruction::FPExt:
                return {arithmetic, width};
            case llvm::Instruction::FDiv:
            case llvm::Instruction::FRem:
            case llvm::Instruction::UDiv:
            case llvm::Instruction::SDiv:
            case llvm::Instruction::URem:
            case llvm::Instruction::SRem:
                return {special, width};
            case llvm::Instruction::Br:
                return {branch, llvm::cast<llvm::BranchInst>(i)->isConditional() ? 1.0 : 0.0};
            case llvm::Instruction::Switch:
                return {branch, 1};
            case llvm::Instruction::Call:
                return costOfCall(*llvm::cast<llvm::CallInst>(i));
            case llvm::Instruction::GetElementPtr: {
                const auto* at = llvm::cast<llvm::GetElementPtrInst>(i);
                return {integer, at->hasAllConstantIndices() || at->getAddressSpace() == 0 ? 0.0 : 1.0};
            }
            case llvm::Instruction::Select:
            case llvm::Instruction::ICmp:
            case llvm::Instruction::Add:
            case llvm::Instruction::Sub:
            case llvm::Instruction::Mul:
            case llvm::Instruction::And:
            case llvm::Instruction::Or:
            case llvm::Instruction::Xor:
            case llvm::Instruction::Shl:
            case llvm::Instruction::LShr:
            case llvm::Instruction::AShr:
                return {integer, width};
            default:
                return {};
        }
    }
    Context* rootOf(const oclgrind::Kernel& kernel) {
        const auto [known, fresh] = roots_.try_emplace({kernel.getProgram()->getUID(), kernel.getName()});
        if (fresh) known->second = contextOf(*kernel.getFunction(), nullptr);
        return known->second;
    }
    // Blocks are numbered so that those of a loop come before all that follow it, and those of a function between those around its call.
    Context* contextOf(const llvm::Function& function, Context* caller) {
        Context& context = contexts_.emplace_back();
        context.caller = caller;
        const llvm::DominatorTree dominators(const_cast<llvm::Function&>(function));
        const llvm::LoopInfo loops(dominators);
        std::vector<const llvm::BasicBlock*> order;  // post-order; from each block the ways out of a loop first
        std::unordered_set<const llvm::BasicBlock*> visited;
        visit(&function.getEntryBlock(), loops, visited, order);
        for (auto block = order.rbegin(); block != order.rend(); ++block) {
            bool begins = true;
            for (const llvm::Instruction& i : **block) {
                Context::Step step{
                    .cost = computeCost(&i), .begins = begins, .returns = llvm::isa<llvm::ReturnInst>(i) && caller != nullptr};
                if (begins) step.part = parts_++;
                const auto* call = llvm::dyn_cast<llvm::CallInst>(&i);
                const llvm::Function* called = call != nullptr ? call->getCalledFunction() : nullptr;
                begins = called != nullptr && !called->isDeclaration();
                if (begins) step.called = contextOf(*called, &context);
                context.steps.emplace(&i, step);
            }
        }
        return &context;
    }
    static void visit(const llvm::BasicBlock* block, const llvm::LoopInfo& loops, std::unordered_set<const llvm::BasicBlock*>& visited,
                      std::vector<const llvm::BasicBlock*>& order) {
        if (!visited.insert(block).second) return;
        std::vector<const llvm::BasicBlock*> next(llvm::succ_begin(block), llvm::succ_end(block));
        const llvm::Loop* loop = loops.getLoopFor(block);
        std::stable_partition(next.begin(), next.end(),
                              [&](const llvm::BasicBlock* each) { return loop != nullptr && !loop->contains(each); });
        for (const llvm::BasicBlock* each : next) visit(each, loops, visited, order);
        order.push_back(block);
    }
    // The operations of threads that run in step: whatever of them is furthest behind goes on, with all that are at the same part, so that
    // threads wait for each other at the end of a loop (Fung et al. 2007 compare such policies).
    double inStep(size_t first, size_t end) {
        at_.assign(end - first, 0);
        double sum = 0;
        for (;;) {
            unsigned next = UINT_MAX;
            for (size_t k = first; k < end; ++k)
                if (at_[k - first] < threads_[k].visits.size()) next = std::min(next, threads_[k].visits[at_[k - first]].part);
            if (next == UINT_MAX) return sum;
            double most = 0;
            for (size_t k = first; k < end; ++k) {
                size_t& at = at_[k - first];
                if (at < threads_[k].visits.size() && threads_[k].visits[at].part == next)
                    most = std::max(most, threads_[k].visits[at++].operations);
            }
            sum += most;
        }
    }

    static size_t indexOf(const oclgrind::WorkItem* item) {
        const oclgrind::Size3 id = item->getLocalID(), size = item->getWorkGroup()->getGroupSize();
        return (id.z * size.y + id.y) * size.x + id.x;
    }
    Thread& threadOf(const oclgrind::WorkItem* item) { return threads_[indexOf(item)]; }

    // The n-th access of an instruction by each thread of 32 is one access of the warp, to the sectors that these threads touch.
    void touch(const oclgrind::WorkItem* item, size_t address, size_t size, std::unordered_set<size_t>& of) {
        const size_t index = indexOf(item), warp = index / 32;
        auto& warps = merged_[item->getCurrentInstruction()];
        if (warps.size() <= warp) warps.resize(warp + 1);
        auto& occurrences = warps[warp];
        std::vector<size_t>& seen = occurrence_[item->getCurrentInstruction()];
        if (seen.size() < threads_.size()) seen.resize(threads_.size());
        size_t& at = seen[index];
        if (occurrences.size() <= at) occurrences.resize(at + 1);
        auto& sectors = occurrences[at];
        ++at;
        for (size_t sector = address / kSector; sector <= (address + size - 1) / kSector; ++sector) {
            if (std::find(sectors.begin(), sectors.end(), sector) == sectors.end()) sectors.push_back(sector);
            touched_.insert(sector);
            of.insert(sector);
        }
    }

    void write() const {
        const char* path = std::getenv("RIVULET_COUNTS");
        if (path == nullptr) return;
        std::FILE* file = std::fopen(path, "w");
        if (file == nullptr) return;
        std::fprintf(file, "kernel,variants,calls,groups,threads");
        for (const char* name : kNames) std::fprintf(file, ",%s", name);
        std::fprintf(file,
                     ",load_bytes,store_bytes,step8,step32,step64,longest,longest_loads,sectors,group_bytes,read_bytes,written_bytes\n");
        for (const auto& [name, s] : all_) {
            std::string variants;
            for (const std::string& each : s.variants) variants += (variants.empty() ? "" : " ") + each;
            std::fprintf(file, "%s,%s,%.0f,%.1f,%.1f", name.substr(0, name.find(',')).c_str(), variants.c_str(), s.calls,
                         s.groups / s.calls, s.threads / s.calls);
            for (const double c : s.count) std::fprintf(file, ",%.4g", c / s.threads);
            std::fprintf(file, ",%.4g,%.4g", s.loadBytes / s.threads, s.storeBytes / s.threads);
            for (const double w : s.inStep) std::fprintf(file, ",%.5g", w / s.threads);
            std::fprintf(file, ",%.5g,%.5g,%.4g,%.4g,%.4g,%.4g\n", s.longest / s.calls, s.longestLoads / s.calls, s.sectors / s.threads,
                         s.groupBytes / s.threads, s.readBytes / s.threads, s.writtenBytes / s.threads);
        }
        std::fclose(file);
    }

    std::map<std::string, Sums> all_;
    std::unordered_map<unsigned long, Origin> origins_;  // by program
    Sums* sums_ = nullptr;
    std::vector<Thread> threads_;
    std::array<double, kClasses> longest_{};
    std::deque<Context> contexts_;
    std::map<std::pair<unsigned long, std::string>, Context*> roots_;  // of kernels, by program and name
    Context* root_ = nullptr;
    unsigned parts_ = 0;
    std::vector<size_t> at_;  // of each thread's visits
    std::unordered_set<size_t> touched_, read_, written_;
    // instruction -> warp -> occurrence -> sectors
    std::unordered_map<const llvm::Instruction*, std::vector<std::vector<std::vector<size_t>>>> merged_;
    std::unordered_map<const llvm::Instruction*, std::vector<size_t>> occurrence_;  // of each thread
};

}  // namespace

static Counter* counter = nullptr;

// Optimised code may declare scopes of restrict pointers, by an intrinsic that Oclgrind 21.10 does not know: LLVM's inliner is told not to.
static void declareNoScopes() {
    auto& options = llvm::cl::getRegisteredOptions();
    const auto found = options.find("use-noalias-intrinsic-during-inlining");
    if (found != options.end()) found->second->addOccurrence(0, found->first(), "false");
}

extern "C" {
void initializePlugins(oclgrind::Context* context) {
    declareNoScopes();
    counter = new Counter(context);
    context->registerPlugin(counter);
}
void releasePlugins(oclgrind::Context* context) {
    context->unregisterPlugin(counter);
    delete counter;
}
}
