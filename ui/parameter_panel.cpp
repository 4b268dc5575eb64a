#include "ui/parameter_panel.h"

#include <QGridLayout>
#include <QLabel>
#include <QLineEdit>
#include <QScrollArea>
#include <QToolButton>
#include <QVBoxLayout>

#include "ui/parameter_row.h"

namespace hl::ui {

ParameterPanel::ParameterPanel(QWidget* parent) : QWidget(parent) {
  auto* outer = new QVBoxLayout(this);
  outer->setContentsMargins(0, 0, 0, 0);
  search_ = new QLineEdit(this);
  search_->setPlaceholderText(tr("Search parameters"));
  search_->setClearButtonEnabled(true);
  search_->setAccessibleName(tr("Search parameters"));
  connect(search_, &QLineEdit::textChanged, this, &ParameterPanel::search);
  outer->addWidget(search_);

  auto* scroll = new QScrollArea(this);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  content_ = new QWidget(scroll);
  layout_ = new QVBoxLayout(content_);
  layout_->setContentsMargins(0, 0, 6, 0);  // clear of the scroll bar
  layout_->setSpacing(2);
  nothing_ = new QLabel(tr("No parameter matches."), content_);
  nothing_->setForegroundRole(QPalette::PlaceholderText);
  nothing_->hide();
  layout_->addWidget(nothing_);
  layout_->addStretch(1);
  scroll->setWidget(content_);
  outer->addWidget(scroll, 1);
}

void ParameterPanel::setGroups(const std::vector<ParameterGroup>& groups) {
  content_->setUpdatesEnabled(false);
  for (Group& g : groups_) {
    layout_->removeWidget(g.box);
    g.box->hide();
    g.box->deleteLater();  // one of its rows may be what asked for this
  }
  groups_.clear();
  for (const ParameterGroup& g : groups) addGroup(g);
  search(search_->text());
  content_->setUpdatesEnabled(true);
}

void ParameterPanel::addGroup(const ParameterGroup& declared) {
  Group g;
  g.id = declared.id;
  g.box = new QWidget(content_);
  auto* column = new QVBoxLayout(g.box);
  column->setContentsMargins(0, 0, 0, 4);
  column->setSpacing(2);

  auto* headerLine = new QHBoxLayout;
  g.header = new QToolButton(g.box);
  g.header->setText(QString::fromStdString(declared.title));
  g.header->setToolButtonStyle(Qt::ToolButtonTextBesideIcon);
  g.header->setAutoRaise(true);
  QFont bold = g.header->font();
  bold.setBold(true);
  g.header->setFont(bold);
  g.reset = new QToolButton(g.box);
  g.reset->setText(tr("\u21ba group"));
  g.reset->setToolTip(tr("All parameters of %1 back to their defaults").arg(QString::fromStdString(declared.title)));
  g.reset->setAutoRaise(true);
  headerLine->addWidget(g.header);
  headerLine->addStretch(1);
  headerLine->addWidget(g.reset);
  column->addLayout(headerLine);

  g.body = new QWidget(g.box);
  auto* grid = new QGridLayout(g.body);
  grid->setContentsMargins(8, 0, 2, 0);
  grid->setHorizontalSpacing(6);
  grid->setVerticalSpacing(3);
  grid->setColumnStretch(0, 5);
  grid->setColumnStretch(1, 4);
  column->addWidget(g.body);

  int line = 0;
  for (const ParamInfo& info : declared.infos) {
    auto* row = new ParameterRow(info, *grid, line++, g.body);
    connect(row, &ParameterRow::dragStarted, this, [this] { ++drag_; });
    connect(row, &ParameterRow::message, this, &ParameterPanel::message);
    connect(row, &ParameterRow::sweepWanted, this, [this, row] { emit sweepWanted(row->info().key()); });
    connect(row, &ParameterRow::edited, this, [this, row](const std::string& text, bool dragging) {
      updateHeaders();
      emit edited({{row->info().key(), text}}, dragging ? drag_ : 0);
    });
    g.rows.push_back(row);
  }

  const bool open = !collapsed_[g.id];
  g.header->setArrowType(open ? Qt::DownArrow : Qt::RightArrow);
  g.body->setVisible(open);
  connect(g.header, &QToolButton::clicked, this, [this, id = g.id, header = g.header, body = g.body] {
    const bool show = collapsed_[id];
    collapsed_[id] = !show;
    header->setArrowType(show ? Qt::DownArrow : Qt::RightArrow);
    body->setVisible(show);
  });
  connect(g.reset, &QToolButton::clicked, this, [this, rows = g.rows] {
    std::map<std::string, std::string> texts;
    for (ParameterRow* row : rows)
      if (!row->isDefault()) texts[row->info().key()] = defaultText(row->info());
    for (ParameterRow* row : rows) row->show(defaultText(row->info()));
    updateHeaders();
    if (!texts.empty()) emit edited(texts, 0);
  });
  layout_->insertWidget(static_cast<int>(groups_.size()), g.box);
  groups_.push_back(std::move(g));
}

void ParameterPanel::setValues(const std::map<std::string, std::string>& values) {
  for (Group& g : groups_)
    for (ParameterRow* row : g.rows) {
      const auto found = values.find(row->info().key());
      const std::string text = found == values.end() ? defaultText(row->info()) : found->second;
      if (text != row->text()) row->show(text);
    }
  updateHeaders();
}

void ParameterPanel::setWaiting(const std::map<std::string, std::string>& values) {
  for (Group& g : groups_)
    for (ParameterRow* row : g.rows) row->setWaiting(values.count(row->info().key()) > 0);
}

void ParameterPanel::updateHeaders() {
  for (Group& g : groups_) {
    bool changed = false;
    for (ParameterRow* row : g.rows) changed |= !row->isDefault();
    g.reset->setEnabled(changed);
  }
}

void ParameterPanel::search(const QString& words) {
  const bool searching = !words.trimmed().isEmpty();
  bool any = false;
  for (Group& g : groups_) {
    bool shown = false;
    for (ParameterRow* row : g.rows) {
      const bool match = !searching || row->matches(words);
      row->setVisible(match);
      shown |= match;
    }
    g.box->setVisible(shown);
    g.body->setVisible(shown && (searching || !collapsed_[g.id]));
    any |= shown;
  }
  nothing_->setVisible(searching && !any);
  updateHeaders();
}

ParameterRow* ParameterPanel::row(const std::string& key) const {
  for (const Group& g : groups_)
    for (ParameterRow* row : g.rows)
      if (row->info().key() == key) return row;
  return nullptr;
}

QToolButton* ParameterPanel::groupResetButton(const std::string& group) const {
  for (const Group& g : groups_)
    if (g.id == group) return g.reset;
  return nullptr;
}

}  // namespace hl::ui
