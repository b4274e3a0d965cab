// SPDX-License-Identifier: Apache-2.0
#include "sim/report/page.h"

#include "daemon/rim/json/json_text.h"
#include "sim/plot/report_style.h"
#include "sim/plot/svg.h"

namespace v2vouch::evaluation {
std::string PageHead(const std::string& title, const std::string& sub) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<title>V2Vouch: " +
         Escape(title) + "</title>\n<style>" + ReportStyle() +
         "</style>\n</head>\n<body><main>\n<h1>V2Vouch: " + Escape(title) +
         "</h1>\n<p class=\"sub\">" + sub + "</p>\n";
}

std::string PageFoot() { return "</main></body></html>\n"; }

std::string Card(const std::string& title, const std::string& text, const std::string& body) {
  return "<section class=\"card\">\n<h2>" + title + "</h2>\n" +
         (text.empty() ? "" : "<p class=\"note\">" + text + "</p>\n") + body + "</section>\n";
}

std::string StoryHtml(const std::string& story) {
  std::string html;
  const std::string text = Escape(story);
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool is_after_digit = i > 0 && text[i - 1] >= '0' && text[i - 1] <= '9';
    const bool is_unit =
        i + 1 < text.size() && (text[i + 1] == 's' || text[i + 1] == 'm' || text[i + 1] == '%');
    if (text[i] == ' ' && is_after_digit && is_unit) {
      html += "&nbsp;";
    } else {
      html += text[i];
    }
  }
  return "<p class=\"story\">" + html + "</p>\n";
}

std::string PicturesHtml(const std::vector<ReportPicture>& pictures) {
  std::string out;
  for (const ReportPicture& picture : pictures) {
    out += "<figure><img style=\"max-width:100%\" alt=\"" + Escape(picture.caption) +
           "\" src=\"data:image/jpeg;base64," + Base64(picture.jpeg) + "\"><figcaption>" +
           Escape(picture.caption) + "</figcaption></figure>\n";
  }
  return out;
}

}  // namespace v2vouch::evaluation
