export { scripts as default } from "../../server/page/eslint.config.js";
