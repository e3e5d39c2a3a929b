export { default } from "../../server/page/prettier.config.js";
