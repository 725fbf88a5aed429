"""One dock panel of plots, with a tab for each group; some groups follow only when nothing moves."""

from dataclasses import dataclass

from viser import ClientHandle, GuiHtmlHandle, GuiTabHandle, Icon, PanelHandle

from explorer.charts import markup
from explorer.charts.chart import Chart, add_chart
from explorer.charts.plot_list import Group
from explorer.charts.pointer import Pointer
from explorer.model.comparison import Comparison
from explorer.model.compute import Picture

FOLLOWS = "Follows as soon as nothing moves."
ICONS = {"Errors": Icon.CHART_LINE, "Observability": Icon.EYE, "Signals": Icon.WAVE_SINE}
ICONS |= {"In depth": Icon.MICROSCOPE, "Twin": Icon.GHOST}


@dataclass(eq=False)
class Said:
    """The sentences above the plots of a group."""

    group: Group
    handle: GuiHtmlHandle

    def draw(self, picture: Picture) -> None:
        assert self.group.say is not None
        self._show(self.group.say(picture))

    def wait(self) -> None:
        """What is below belongs to an earlier picture, and says so."""
        self._show((FOLLOWS,))

    def _show(self, sentences: tuple[str, ...]) -> None:
        content = markup.sentences(sentences)
        if content != self.handle.content:
            self.handle.content = content


class Column:
    """One dock panel, with a tab for each group."""

    def __init__(self, client: ClientHandle, groups: tuple[Group, ...], pointer: Pointer, *, height: int) -> None:
        self._client, self._groups, self._height = client, groups, height
        self._off: dict[str, set[int]] = {plot.name: set() for group in groups for plot in group.plots}
        self.panel: PanelHandle = client.gui.add_panel()
        self._tabs: list[GuiTabHandle] = []
        self._charts: list[list[Chart]] = []
        self._said: list[list[Said]] = []
        self._add_tab(groups[0])
        with self._tabs[0]:
            pointer.add_to(client.gui)
            self.live = client.gui.add_html("", order=-1.0)
        for group in groups[1:]:
            self._add_tab(group)
        self.panel.dock_left()

    def draw(self, picture: Picture, beside: Comparison) -> None:
        for group, charts, said in zip(self._groups, self._charts, self._said, strict=True):
            if group.later:
                for sentences in said:
                    sentences.wait()
                for chart in charts:
                    chart.stale = True
            else:
                self._draw_group(picture, beside, charts, said)

    def draw_later(self, picture: Picture, beside: Comparison) -> None:
        for group, charts, said in zip(self._groups, self._charts, self._said, strict=True):
            if group.later:
                self._draw_group(picture, beside, charts, said)

    def _draw_group(self, picture: Picture, beside: Comparison, charts: list[Chart], said: list[Said]) -> None:
        for chart in charts:
            chart.draw(picture, beside)
        for sentences in said:
            sentences.draw(picture)

    def keep_only_first_tab(self) -> None:
        """Remove all tabs but the first, and add them again behind it."""
        for tab in self._tabs[1:]:
            tab.remove()
        del self._tabs[1:], self._charts[1:], self._said[1:]
        for group in self._groups[1:]:
            self._add_tab(group)

    @property
    def charts(self) -> list[Chart]:
        """Of all tabs."""
        return [chart for charts in self._charts for chart in charts]

    def _add_tab(self, group: Group) -> None:
        tab = self.panel.add_tab(group.title, ICONS[group.title])
        self._tabs.append(tab)
        with tab:
            self._said.append([Said(group, self._client.gui.add_html(""))] if group.say else [])
            self._charts.append(
                [add_chart(self._client, plot, self._height, self._off[plot.name]) for plot in group.plots]
            )
