#include "engine/core/param_fixed.h"

#include <deque>
#include <variant>

#include "engine/core/assert.h"

namespace rivulet {

namespace {

// Collects what is fixed, in the order of the visit, or puts it back.
class FixedValues final : public ParamVisitor {
  public:
    void putBack() { reading_ = false; }

    void value(const ParamInfo& info, float& v) override { pass(info, v); }
    void value(const ParamInfo& info, int& v) override { pass(info, v); }
    void value(const ParamInfo& info, bool& v) override { pass(info, v); }
    void value(const ParamInfo& info, std::string& v) override { pass(info, v); }
    void value(const ParamInfo& info, vec3& v) override { pass(info, v); }
    void colour(const ParamInfo& info, vec3& v) override { pass(info, v); }
    void choice(const ParamInfo& info, std::string& v, std::span<const std::string>) override { pass(info, v); }

  protected:
    bool beginGroup(const ParamInfo&) override { return true; }
    void endGroup() override {}
    size_t beginList(const ParamInfo& info, size_t current) override {
        if (fixedLists_ == 0 && !info.fixed) {
            ++liveLists_;
            return current;
        }
        ++fixedLists_;
        keep(current);
        return current;
    }
    void beginItem(size_t) override {}
    void endItem() override {}
    void endList() override { --(fixedLists_ > 0 ? fixedLists_ : liveLists_); }

  private:
    template <class T>
    void pass(const ParamInfo& info, T& v) {
        if (fixedLists_ == 0 && !info.fixed) return;
        ASSERT(fixedLists_ > 0 || liveLists_ == 0, "mark a list that holds fixed values as fixed");
        keep(v);
    }
    template <class T>
    void keep(T& v) {
        if (reading_) {
            kept_.emplace_back(v);
            return;
        }
        v = std::get<T>(kept_.front());
        kept_.pop_front();
    }
    std::deque<std::variant<float, int, bool, std::string, vec3, size_t>> kept_;  // size_t: the length of a list
    bool reading_ = true;
    int fixedLists_ = 0, liveLists_ = 0;  // that the visit is inside of
};

}  // namespace

void keepFixed(const VisitFn& next, const VisitFn& old) {
    FixedValues values;
    old(values);
    values.putBack();
    next(values);
}

}  // namespace rivulet
