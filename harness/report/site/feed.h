#pragma once
#include <ctime>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace gnomon::site {

/// When each entry was first in a feed, by its id: text of ISO 8601.
using FeedTimes = std::map<std::string, std::string>;

/// Those of a feed that atom_feed wrote; none of any other text.
FeedTimes feed_times(std::string_view feed);

/// The changes of docs/changes.md as an Atom feed: an entry for each item of its lists, whose title is the text in bold that it
/// opens with. `known` has the times of entries that were in the feed before; new ones have the time `now`.
std::string atom_feed(std::string_view changes, const FeedTimes& known, std::time_t now);

}  // namespace gnomon::site
