#include "ui/undo_commands.h"

#include <utility>

#include "ui/document.h"

namespace hl::ui {

PresetCommand::PresetCommand(Document& document, Preset before, Preset after, const QString& what, quint64 drag)
    : QUndoCommand(what),
      document_(document),
      before_(std::move(before)),
      after_(std::move(after)),
      drag_(drag) {}

PresetCommand* PresetCommand::opened(Document& document, Preset before, Preset after, const QString& what) {
  auto* command = new PresetCommand(document, std::move(before), std::move(after), what, 0);
  command->whole_ = command->applied_ = true;
  return command;
}

PresetCommand* PresetCommand::whole(Document& document, Preset before, Preset after, const QString& what) {
  PresetCommand* command = opened(document, std::move(before), std::move(after), what);
  command->applied_ = false;
  return command;
}

void PresetCommand::undo() { document_.apply(before_, whole_); }

void PresetCommand::redo() {
  if (!std::exchange(applied_, false)) document_.apply(after_, whole_);
}

bool PresetCommand::mergeWith(const QUndoCommand* next) {
  const auto* other = static_cast<const PresetCommand*>(next);  // every command here is one
  if (drag_ == 0 || drag_ != other->drag_) return false;
  after_ = other->after_;
  setText(other->text());
  // A drag that came back to where it began is no step.
  setObsolete(presetJson(before_) == presetJson(after_));
  return true;
}

}  // namespace hl::ui
