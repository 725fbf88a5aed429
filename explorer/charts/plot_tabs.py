"""A dock panel of plots, with a tab for each group of plots. Slow groups are drawn only when nothing changes, and all
plots only while they are in sight."""

from dataclasses import dataclass

from viser import ClientHandle, GuiHtmlHandle, GuiTabHandle, PanelHandle

from explorer.charts import markup
from explorer.charts.chart import Chart, ChartStyle, add_chart
from explorer.charts.plot_list import Group
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture

OUTDATED = "Follows as soon as nothing moves."


@dataclass(eq=False)
class GroupText:
    """The sentences above the plots of a group."""

    group: Group
    handle: GuiHtmlHandle

    def draw(self, picture: Picture, comparison: Comparison) -> None:
        assert self.group.describe is not None
        sentences, a = self.group.describe(picture), comparison.pinned
        if a is not None and self.group.compare is not None:
            sentences += self.group.compare(a, picture)
        self._show(sentences)

    def mark_outdated(self) -> None:
        """Say that the plots below belong to an earlier picture."""
        self._show((OUTDATED,))

    def _show(self, sentences: tuple[str, ...]) -> None:
        content = markup.paragraphs(sentences)
        if content != self.handle.content:
            self.handle.content = content


class PlotPanel:
    """One dock panel, with a tab for each group."""

    def __init__(
        self,
        client: ClientHandle,
        groups: tuple[Group, ...],
        switched_off: dict[str, set[int]],
        style: ChartStyle,
    ) -> None:
        """`switched_off` are the curves of each plot that the visitor has switched off."""
        self._client, self._groups, self._style, self._switched_off = client, groups, style, switched_off
        self.panel: PanelHandle = client.gui.add_panel()
        self._tabs: list[GuiTabHandle] = []
        self._charts: list[list[Chart]] = []
        self._texts: list[list[GroupText]] = []
        for group in groups:
            self._add_tab(group)
        self.panel.dock_left()

    def mark_outdated(self) -> None:
        """Let every plot follow when it is drawn next."""
        for chart in self.charts:
            chart.outdated = True

    def draw(self, picture: Picture, comparison: Comparison, *, in_sight: frozenset[str] | None, settled: bool) -> None:
        """Draw the outdated plots of the names that are `in_sight`, or of all names; slow groups only if nothing has
        changed for a moment (`settled`)."""
        for group, charts, texts in zip(self._groups, self._charts, self._texts, strict=True):
            outdated = [chart for chart in charts if chart.outdated and chart.is_among(in_sight)]
            if outdated and group.slow and not settled:
                for text in texts:
                    text.mark_outdated()
            elif outdated:
                for chart in outdated:
                    chart.draw(picture, comparison)
                for text in texts:
                    text.draw(picture, comparison)

    def restyle(self, style: ChartStyle) -> None:
        """Draw all plots in another size."""
        self._style = style
        for chart in self.charts:
            chart.restyle(style)

    def keep_only_first_tab(self) -> None:
        """Remove all tabs but the first, and add them again behind it."""
        for tab in self._tabs[1:]:
            tab.remove()
        del self._tabs[1:], self._charts[1:], self._texts[1:]
        for group in self._groups[1:]:
            self._add_tab(group)

    @property
    def charts(self) -> list[Chart]:
        """The charts of all tabs."""
        return [chart for charts in self._charts for chart in charts]

    def _add_tab(self, group: Group) -> None:
        tab = self.panel.add_tab(group.title, group.icon)
        self._tabs.append(tab)
        with tab:
            self._texts.append([GroupText(group, self._client.gui.add_html(""))] if group.describe else [])
            self._charts.append(
                [add_chart(self._client, plot, self._style, self._switched_off[plot.name]) for plot in group.plots]
            )
