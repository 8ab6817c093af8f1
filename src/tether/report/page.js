// What a page does: light and dark, plots and 3D views once they come into sight, buttons that copy, and printing.
"use strict";
(() => {
    const root = document.documentElement;
    const prefersDark = matchMedia("(prefers-color-scheme: dark)");
    const held = (element) => JSON.parse(element.textContent);
    const templates = held(document.getElementById("templates") ?? { textContent: "{}" });
    const shown = new Set(); // plots that have been drawn
    const SETTINGS = {
        responsive: true, displaylogo: false, displayModeBar: matchMedia("(hover: hover)").matches ? "hover" : false,
        modeBarButtonsToRemove: ["select2d", "lasso2d", "zoomIn2d", "zoomOut2d"],
    };

    // --- light and dark: the reader's wish, or else the system's ---
    let wish = null;
    const button = document.getElementById("theme");
    function setTheme(theme) {
        root.dataset.theme = theme;
        button.textContent = theme === "dark" ? "Light" : "Dark";
        button.setAttribute("aria-label", `change to ${theme === "dark" ? "light" : "dark"} colors`);
        shown.forEach(drawPlot);
        document.dispatchEvent(new CustomEvent("themechange", { detail: theme }));
    }
    const theme = () => wish ?? (prefersDark.matches ? "dark" : "light");
    button.addEventListener("click", () => {
        wish = root.dataset.theme === "dark" ? "light" : "dark";
        setTheme(wish);
    });
    prefersDark.addEventListener("change", () => setTheme(theme()));

    // --- plots and views: drawn when they come into sight, which those of a shut section never do ---
    function drawPlot(plot) {
        const figure = (plot.figure ??= held(plot.parentElement.querySelector("script")));
        const layout = { template: templates[root.dataset.theme], ...figure.layout };
        shown.add(plot);
        return Plotly.react(plot, figure.data, layout, SETTINGS);
    }
    const draw = (element) =>
        element.matches(".plot") ? drawPlot(element) : tetherViewer.show(element, held(element.querySelector("script")));
    const waiting = new Set(document.querySelectorAll(".plot, .suspension"));
    const watch = new IntersectionObserver((entries) => {
        for (const { target, isIntersecting } of entries) {
            if (isIntersecting && waiting.delete(target)) {
                watch.unobserve(target);
                draw(target);
            }
        }
    }, { rootMargin: "800px" });
    setTheme(theme());
    waiting.forEach((element) => watch.observe(element));

    // --- copying ---
    for (const copy of document.querySelectorAll("button.copy")) {
        const words = copy.textContent;
        copy.addEventListener("click", async () => {
            const code = copy.parentElement.querySelector("code");
            try {
                await navigator.clipboard.writeText(code.textContent);
                copy.textContent = "Copied";
            } catch { // no clipboard for pages from a disk in some browsers: then it is only selected
                getSelection().selectAllChildren(code);
                copy.textContent = "Selected";
            }
            setTimeout(() => { copy.textContent = words; }, 1500);
        });
    }

    // --- a link into a shut section opens it; printing shows everything, in light colors ---
    function open() {
        const target = location.hash && document.getElementById(decodeURIComponent(location.hash.slice(1)));
        if (target) target.closest("details")?.setAttribute("open", "");
    }
    addEventListener("hashchange", open);
    open();
    addEventListener("beforeprint", () => {
        document.querySelectorAll("details").forEach((each) => each.setAttribute("open", ""));
        setTheme("light");
        for (const element of waiting) {
            if (element.matches(".plot")) {
                waiting.delete(element);
                drawPlot(element);
            }
        }
    });
    addEventListener("afterprint", () => setTheme(theme()));
})();
