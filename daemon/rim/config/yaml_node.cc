// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/config/yaml_node.h"

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <utility>

namespace v2vouch::config {
namespace {

struct Refusal {
  int line;
  std::string what;
};

// Takes the parser's events, so that depth is bounded while yaml-cpp descends (it is recursive) and
// repeated keys are seen (its own nodes hide them).
class TreeBuilder final : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Add(mark, anchor, "", YamlNode::Type::kEmpty);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw Refusal{LineOf(mark), "anchors and aliases are not supported"};
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    YamlNode& node = Add(mark, anchor, tag, YamlNode::Type::kScalar);
    node.text = value;
    node.is_quoted = tag == "!";
    if (value.find('\0') != std::string::npos) throw Refusal{node.line, "holds a NUL"};
    FinishKey();
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    Descend(Add(mark, anchor, tag, YamlNode::Type::kList));
  }
  void OnSequenceEnd() override { open_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    Descend(Add(mark, anchor, tag, YamlNode::Type::kMap));
  }
  void OnMapEnd() override { open_.pop_back(); }

  YamlNode root;

 private:
  static int LineOf(const YAML::Mark& mark) { return mark.line + 1; }

  // Where the next value goes: the root, the end of the open list, or key and value of the open map
  // in turn. Only the innermost open node grows, so that the pointers in open_ stay good.
  YamlNode& Add(const YAML::Mark& mark, YAML::anchor_t anchor, const std::string& tag,
                YamlNode::Type type) {
    const int line = LineOf(mark);
    if (anchor != 0) throw Refusal{line, "anchors and aliases are not supported"};
    if (!tag.empty() && tag != "?" && tag != "!") throw Refusal{line, "tags are not supported"};
    YamlNode* node = &root;
    is_key_ = false;
    if (!open_.empty()) {
      YamlNode& parent = *open_.back();
      is_key_ = parent.type == YamlNode::Type::kMap && parent.keys.size() == parent.items.size();
      if (is_key_) {
        if (type != YamlNode::Type::kScalar) throw Refusal{line, "a key must be a plain word"};
        node = &key_;
        *node = {};
      } else {
        node = &parent.items.emplace_back();
      }
    }
    node->type = type;
    node->line = line;
    return *node;
  }

  void FinishKey() {
    if (is_key_) open_.back()->keys.push_back(key_.text);
  }

  void Descend(YamlNode& node) {
    if (open_.size() >= kMaxDepth) throw Refusal{node.line, "nested too deeply"};
    open_.push_back(&node);
  }

  std::vector<YamlNode*> open_;
  YamlNode key_;
  bool is_key_ = false;
};

}  // namespace

std::optional<YamlNode> ParseYaml(std::string_view text, const std::string& name,
                                  std::vector<std::string>& problems) {
  if (text.size() > kMaxFileBytes) {
    problems.push_back(name + ": larger than " + std::to_string(kMaxFileBytes) + " bytes");
    return std::nullopt;
  }
  try {
    std::istringstream stream{std::string(text)};
    YAML::Parser parser(stream);
    TreeBuilder builder;
    if (!parser.HandleNextDocument(builder)) builder.root.type = YamlNode::Type::kEmpty;
    TreeBuilder more;
    if (parser.HandleNextDocument(more)) throw Refusal{more.root.line, "a second document"};
    return std::move(builder.root);
  } catch (const Refusal& refusal) {
    problems.push_back(name + ":" + std::to_string(refusal.line) + ": " + refusal.what);
  } catch (const YAML::Exception& error) {
    problems.push_back(name + ":" + std::to_string(error.mark.line + 1) + ": " + error.msg);
  } catch (const std::exception& error) {
    problems.push_back(name + ": " + error.what());
  }
  return std::nullopt;
}

std::optional<std::string> ReadFile(const std::string& path, std::vector<std::string>& problems) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) {
    problems.push_back(path + ": is a folder");
    return std::nullopt;
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    problems.push_back(path + ": " + std::strerror(errno));
    return std::nullopt;
  }
  std::string content(kMaxFileBytes + 1, '\0');
  file.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(file.gcount()));
  if (content.size() > kMaxFileBytes) {
    problems.push_back(path + ": larger than " + std::to_string(kMaxFileBytes) + " bytes");
    return std::nullopt;
  }
  return content;
}

}  // namespace v2vouch::config
