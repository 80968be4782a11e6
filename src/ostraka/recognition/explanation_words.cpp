// SPDX-License-Identifier: Apache-2.0
#include "ostraka/recognition/explanation_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "ostraka/recognition/confidence.hpp"

namespace ostraka {
namespace {

constexpr double kWorthSaying = 0.3;  // logits: about 7 % of confidence where it is even
constexpr std::size_t kMostClauses = 3;
constexpr double kNearlyAsWell = 0.3;  // of the object's probability: that of a rival which is said
                                       // to explain nearly as much

// Features that tell of one thing, by their names, and what right reports have.
struct FeatureFacts {
    std::string_view name;
    std::string_view topic;
    double typical;
};
// Medians of the right reports that the general weights were learned from.
constexpr std::array<FeatureFacts, 20> kFacts = {{{"constant", "", 1.0},
                                                  {"clearness", "agreement", 0.961},
                                                  {"surplus", "fit", 0.0},
                                                  {"turned", "fit", 0.02},
                                                  {"visible", "visible", 1.699},
                                                  {"area", "size", 1.386},
                                                  {"cells", "size", 1.709},
                                                  {"grip", "grip", 0.424},
                                                  {"sharpness", "sharpness", 0.059},
                                                  {"open", "outline", 0.004},
                                                  {"level", "outline", 0.014},
                                                  {"folded", "outline", 0.0},
                                                  {"joined", "outline", 0.0},
                                                  {"fenced", "outline", 0.0},
                                                  {"ended", "outline", 1.812},
                                                  {"sunk", "sunk", 0.0},
                                                  {"solid", "contradiction", 0.0},
                                                  {"blank", "blank", 0.0},
                                                  {"hollow", "hollow", 0.0},
                                                  {"rival", "rival", 0.0}}};

// Nothing of a feature that is not in the list.
const FeatureFacts* facts_of(Feature feature) {
    const auto at = std::find_if(kFacts.begin(), kFacts.end(), [&](const FeatureFacts& facts) {
        return facts.name == feature_name(feature);
    });
    return at == kFacts.end() ? nullptr : &*at;
}

std::string_view topic_of(Feature feature) {
    const FeatureFacts* facts = facts_of(feature);
    return facts == nullptr ? feature_name(feature) : facts->topic;
}

// Small shares keep a digit, so that what is there isn't said to be nothing.
std::string percent(double share) {
    const double value = 100.0 * share;
    return value > 0.0 && value < 1.0 ? fmt::format("{:.1f} %", value)
                                      : fmt::format("{:.0f} %", value);
}

double share(std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string agreement_words(const Verified& v, bool against) {
    const std::size_t judged = v.support + v.violation + v.backdrop + v.missing;
    if (!against) {
        return fmt::format("the scan confirms {} of what should be seen",
                           percent(share(v.support, judged)));
    }
    std::vector<std::pair<std::size_t, std::string>> parts = {
        {v.violation,
         "is contradicted (the sensor looked through it, or the surface faces "
         "elsewhere)"},
        {v.backdrop, "lies on a flat surface larger than the model"},
        {v.missing, "was not measured"}};
    std::stable_sort(parts.begin(), parts.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::string words;
    for (const auto& [cells, what] : parts) {
        if (words.empty()) {
            words =
                fmt::format("{} of what should be seen {}", percent(share(cells, judged)), what);
        } else if (share(cells, judged) >= 0.03) {
            words += fmt::format(", {} {}", percent(share(cells, judged)), what);
        }
    }
    return words;
}

std::string fit_words(const Verified& v, bool against, const std::string& unit) {
    const double degrees = std::acos(std::clamp(1.0 - v.turned, -1.0, 1.0)) * 180.0 / M_PI;
    const std::string length =
        fmt::format("{:.2g}{}{}", v.inlier_rms, unit.empty() ? "" : " ", unit);
    if (against) {
        return fmt::format("it fits only to {}, with surfaces turned by {:.0f} degrees", length,
                           degrees);
    }
    return fmt::format("it fits to {}", length);
}

std::string size_words(const Verified& v, bool against) {
    return against ? fmt::format("little of it is seen: {} cells of the range map", v.support)
                   : fmt::format("much of it is seen: {} cells of the range map", v.support);
}

// Of what is against it, that which is rarest of right ones.
std::string outline_words(const OutlineEvidence& outline, bool against) {
    if (!against) return "the scan's surface ends where the model ends";
    constexpr double kSome = 0.03;
    if (outline.open >= kSome) {
        return fmt::format(
            "along {} of its outline the scan goes on as one smooth surface: it may be a piece of "
            "something larger",
            percent(outline.open));
    }
    if (outline.folded >= kSome) {
        return fmt::format(
            "along {} of its outline the scan's surface bends away and goes on: a face that the "
            "model lacks",
            percent(outline.folded));
    }
    if (outline.joined >= kSome) {
        return fmt::format(
            "along {} of its outline something in front begins at the scan's surface: it may grow "
            "out of it",
            percent(outline.joined));
    }
    if (outline.fenced >= kOftenFenced) {
        return fmt::format("along {} of its outline something nearer begins just where it ends",
                           percent(outline.fenced));
    }
    if (outline.level >= kSome) {
        return fmt::format("along {} of its outline something as high is beside it",
                           percent(outline.level));
    }
    return "its outline is hardly seen: what it agrees with may be part of something else";
}

// Whether the numbers are worse than usual: weights that were fitted may say the opposite of what
// a person would, and words that contradict themselves help nobody.
bool worse_than_usual(std::string_view topic, const Explanation& one) {
    const auto value = [&](Feature feature) {
        return one.object.features[static_cast<std::size_t>(feature)];
    };
    const auto lower = [&](Feature f) { return value(f) < typical_value(f); };
    const auto higher = [&](Feature f) { return value(f) > typical_value(f); };
    if (topic == "agreement") return lower(Feature::clearness);
    if (topic == "fit") return higher(Feature::surplus);
    if (topic == "visible") return lower(Feature::visible);
    if (topic == "size") return lower(Feature::cells) || lower(Feature::area);
    if (topic == "grip") return lower(Feature::grip);
    if (topic == "sharpness") return lower(Feature::sharpness);
    if (topic == "outline") {
        return higher(Feature::open) || higher(Feature::level) || higher(Feature::folded) ||
               higher(Feature::joined) || higher(Feature::fenced) || lower(Feature::ended);
    }
    if (topic == "sunk") return higher(Feature::sunk);
    if (topic == "contradiction") return higher(Feature::solid);
    if (topic == "blank") return higher(Feature::blank);
    if (topic == "hollow") return higher(Feature::hollow);
    if (topic == "rival") return higher(Feature::rival);
    return true;
}

// With the odds o of the object and r of its rivals: r / (1 + o + r).
double rival_probability(const RecognizedObject& object) {
    const double rival = object.features[static_cast<std::size_t>(Feature::rival)];
    return (1.0 - object.confidence) * (1.0 - std::exp(-rival));
}

std::string words_for(std::string_view topic, const Explanation& one, bool against,
                      const std::string& unit) {
    const Verified& v = one.verified;
    if (topic == "agreement") return agreement_words(v, against);
    if (topic == "fit") return fit_words(v, against, unit);
    if (topic == "size") return size_words(v, against);
    if (topic == "visible") {
        return fmt::format("{}{} of its silhouette is seen", against ? "only " : "",
                           percent(v.visible_fraction));
    }
    if (topic == "grip") {
        return against ? "what is seen is nearly flat or round and would fit elsewhere, too"
                       : "what is seen holds it in place in all directions";
    }
    if (topic == "sharpness") {
        return against ? "moved a little, it would agree nearly as well"
                       : "moved a little, it would agree much worse";
    }
    if (topic == "outline") return outline_words(v.outline, against);
    if (topic == "sunk") {
        return against ? fmt::format("{} of it would be below the table", percent(v.sunk))
                       : "nothing of it is below the table";
    }
    if (topic == "contradiction") {
        if (!against) return "nothing contradicts it but at edges";
        if (v.inside > 0) return fmt::format("{} points of the scan lie inside it", v.inside);
        const std::string together =
            v.solid > 0 ? fmt::format(", {} of them inside one piece", v.solid) : "";
        return fmt::format(
            "{} cells contradict it{}: the sensor looked through it there, or the surface faces "
            "elsewhere",
            v.violation + v.backdrop, together);
    }
    if (topic == "blank") {
        return against ? fmt::format("nothing was measured in pieces of it: {} cells", v.blank)
                       : "it was measured wherever it can be seen";
    }
    if (topic == "hollow") {
        return against ? fmt::format("it covers holes of the scan's surface: {} cells", v.hollow)
                       : "the scan has no holes that it lacks";
    }
    if (topic == "rival") {
        if (one.object.rival.empty()) return "no other model explains the same";
        const double probability = rival_probability(one.object);
        const bool nearly = probability > kNearlyAsWell * one.object.confidence;
        return fmt::format("{} explains the same {}: it is that with a probability of {}",
                           one.object.rival, nearly ? "nearly as well" : "less well",
                           percent(probability));
    }
    return fmt::format("its {} is {}", topic, against ? "unusual" : "as usual");
}

bool is_against(const Reason& reason, const Explanation& one) {
    return reason.contribution < -kWorthSaying && worse_than_usual(reason.topic, one);
}

std::string joined(const std::vector<std::string>& clauses) {
    return fmt::format("{}", fmt::join(clauses, "; "));
}

// What speaks for it and, if it matters, what against.
std::string evidence_words(const Explanation& one, bool both) {
    std::vector<std::string> good;
    std::vector<std::string> bad;
    for (const Reason& reason : one.reasons) {
        if (is_against(reason, one) && bad.size() < kMostClauses) bad.push_back(reason.words);
    }
    for (const std::string_view topic :
         {"agreement", "fit", "visible", "outline", "grip", "sharpness"}) {
        for (const Reason& reason : one.reasons) {
            if (reason.topic != topic || is_against(reason, one)) continue;
            // "The outline ends" and the like are worth words where they tell more than usual.
            const bool telling = topic != "outline" && topic != "grip" && topic != "sharpness";
            if (!telling && reason.contribution < 0.0) continue;
            if (good.size() < kMostClauses) good.push_back(reason.words);
        }
    }
    std::string words;
    if (!bad.empty()) words += " Against it: " + joined(bad) + ".";
    if (both && !good.empty()) {
        const std::string says = " For it: " + joined(good) + ".";
        words = one.outcome == Outcome::reported ? says + words : words + says;
    }
    return words;
}

}  // namespace

double typical_value(Feature feature) {
    const FeatureFacts* facts = facts_of(feature);
    return facts == nullptr ? 0.0 : facts->typical;
}

std::vector<Reason> reasons_of(const Explanation& explanation, const ConfidenceModel& confidence,
                               const std::string& unit) {
    std::vector<Reason> reasons;
    for (std::size_t i = 0; i < kFeatures; ++i) {
        const auto feature = static_cast<Feature>(i);
        const std::string_view topic = topic_of(feature);
        if (topic.empty()) continue;
        auto reason = std::find_if(reasons.begin(), reasons.end(),
                                   [&](const Reason& known) { return known.topic == topic; });
        if (reason == reasons.end()) {
            reason = reasons.insert(reasons.end(), Reason{.topic = std::string(topic)});
        }
        reason->contribution +=
            confidence.weights[i] * (explanation.object.features[i] - typical_value(feature));
    }
    for (Reason& reason : reasons) {
        reason.words = words_for(reason.topic, explanation, is_against(reason, explanation), unit);
    }
    std::stable_sort(reasons.begin(), reasons.end(), [](const Reason& a, const Reason& b) {
        return std::abs(a.contribution) > std::abs(b.contribution);
    });
    return reasons;
}

std::string object_label(std::span<const RecognizedObject> objects, std::uint32_t number) {
    return fmt::format("{} #{}", objects[number].model, number + 1);
}

std::string verdict_of(const Explanation& one, std::span<const RecognizedObject> objects,
                       double min_confidence) {
    const double confidence = one.object.confidence;
    std::string rival;
    if (one.rival < objects.size()) {
        const RecognizedObject& winner = objects[one.rival];
        const bool same = winner.model_index == one.object.model_index;
        rival = fmt::format(
            "{} is explained better by {} ({:.2f})",
            same ? "it is one more pose of the same model: the scan there" : "what it explains",
            object_label(objects, one.rival), winner.confidence);
    }
    switch (one.outcome) {
        case Outcome::reported:
            return fmt::format("Reported: confidence {:.2f}.", confidence) +
                   evidence_words(one, true);
        case Outcome::lost:
            if (rival.empty()) rival = "together, the reported objects explain more";
            return fmt::format("Not reported: {}; its own confidence is {:.2f}.", rival,
                               confidence) +
                   evidence_words(one, true);
        case Outcome::too_small:
            return fmt::format(
                       "Not reported: only {} cells of the range map agree with it, too "
                       "few to say anything.",
                       one.verified.support) +
                   evidence_words(one, false);
        case Outcome::doubtful:
            break;
    }
    std::string words = fmt::format("Not reported: confidence {:.2f} is below {:.2f}.", confidence,
                                    min_confidence) +
                        evidence_words(one, true);
    if (!rival.empty()) words += " Besides, " + rival + ".";
    return words;
}

}  // namespace ostraka
