// SPDX-License-Identifier: Apache-2.0
// A strict little XML parser: enough to prove that what is written is well-formed, and to find
// shapes by their attributes. Knows no DTD, CDATA or processing instructions.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace ostraka::report_testing {

struct Element {
    std::string tag;
    std::map<std::string, std::string> attributes;  // entities decoded
    std::string text;                               // directly within it, entities decoded
    std::string parent;                             // tag
    std::vector<std::string> classes() const {
        std::vector<std::string> names(1);
        const auto found = attributes.find("class");
        if (found == attributes.end()) return {};
        for (const char c : found->second) {
            if (c == ' ') {
                names.emplace_back();
            } else {
                names.back() += c;
            }
        }
        return names;
    }
    bool has_class(const std::string& name) const {
        const std::vector<std::string> names = classes();
        return std::find(names.begin(), names.end(), name) != names.end();
    }
    double number(const std::string& name) const { return std::stod(attributes.at(name)); }
};

class XmlParser {
  public:
    explicit XmlParser(std::string_view text) : rest_(text) {}

    /// In the order of their start tags. @throws std::runtime_error if the text isn't well-formed.
    std::vector<Element> parse() {
        skip("<!DOCTYPE html>");
        blanks();
        while (!rest_.empty()) {
            if (skip("</")) {
                close();
            } else if (skip("<")) {
                if (open_.empty() && !found_.empty()) fail("a second root");
                open();
            } else {
                const std::string text = decoded(take_until("<"));
                if (open_.empty()) {
                    if (text.find_first_not_of(" \n") != std::string::npos) fail("text outside");
                } else {
                    found_[open_.back()].text += text;
                }
            }
        }
        if (!open_.empty()) fail("<" + found_[open_.back()].tag + "> isn't closed");
        if (found_.empty()) fail("no element");
        return found_;
    }

  private:
    [[noreturn]] static void fail(const std::string& problem) { throw std::runtime_error(problem); }

    bool skip(std::string_view start) {
        if (!rest_.starts_with(start)) return false;
        rest_.remove_prefix(start.size());
        return true;
    }

    void blanks() {
        while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\n')) rest_.remove_prefix(1);
    }

    std::string_view take_until(std::string_view ends) {
        const std::string_view taken = rest_.substr(0, rest_.find_first_of(ends));
        rest_.remove_prefix(taken.size());
        return taken;
    }

    static std::string decoded(std::string_view text) {
        const std::map<std::string, std::string, std::less<>> entities = {
            {"&amp;", "&"}, {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&#39;", "'"}};
        std::string out;
        while (!text.empty()) {
            if (text[0] == '&') {
                const std::string_view entity = text.substr(0, text.find(';') + 1);
                if (!entities.contains(entity)) fail("an unknown entity");
                out += entities.find(entity)->second;
                text.remove_prefix(entity.size());
                continue;
            }
            if (text[0] == '\0' || text[0] == '\x1b') fail("a control character");
            out += text[0];
            text.remove_prefix(1);
        }
        return out;
    }

    void open() {
        Element element;
        element.tag = take_until(" />\n");
        if (element.tag.empty()) fail("a tag without a name");
        if (!open_.empty()) element.parent = found_[open_.back()].tag;
        for (blanks(); !rest_.starts_with(">") && !rest_.starts_with("/>"); blanks()) {
            const std::string name(take_until("= />\n"));
            if (name.empty() || !skip("=\"")) fail("an attribute without a value");
            const std::string_view value = take_until("\"");
            if (value.find('<') != std::string_view::npos || !skip("\"")) fail("an open attribute");
            if (!element.attributes.emplace(name, decoded(value)).second) fail("a double " + name);
        }
        found_.push_back(element);
        if (skip("/>")) return;
        skip(">");
        open_.push_back(found_.size() - 1);
    }

    void close() {
        const std::string_view tag = take_until(">");
        if (!skip(">") || open_.empty() || found_[open_.back()].tag != tag) {
            fail("</" + std::string(tag) + "> closes another");
        }
        open_.pop_back();
    }

    std::string_view rest_;
    std::vector<Element> found_;
    std::vector<std::size_t> open_;
};

inline std::vector<Element> parse_xml(std::string_view text) {
    try {
        return XmlParser(text).parse();
    } catch (const std::runtime_error& error) {
        ADD_FAILURE() << error.what() << " in\n" << text;
        return {Element{}};
    }
}

inline std::vector<Element> with_tag(const std::vector<Element>& elements, const std::string& tag) {
    std::vector<Element> found;
    for (const Element& element : elements) {
        if (element.tag == tag) found.push_back(element);
    }
    return found;
}

inline std::vector<Element> with_class(const std::vector<Element>& elements,
                                       const std::string& name) {
    std::vector<Element> found;
    for (const Element& element : elements) {
        if (element.has_class(name)) found.push_back(element);
    }
    return found;
}

/// The first element of that tag with that text; a failure if there is none.
inline Element with_text(const std::vector<Element>& elements, const std::string& tag,
                         const std::string& text) {
    for (const Element& element : elements) {
        if (element.tag == tag && element.text == text) return element;
    }
    ADD_FAILURE() << "no <" << tag << "> says " << text;
    return {};
}

inline bool says(const std::vector<Element>& elements, const std::string& text) {
    return std::any_of(elements.begin(), elements.end(),
                       [&](const Element& element) { return element.text == text; });
}

}  // namespace ostraka::report_testing
